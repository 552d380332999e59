// The CUDA backend: kernels of src/core's decisions on one card. One object
// works on one image at a time, in a stream of its own; several objects on one
// card overlap their transfers and host work.
#pragma once

#include "src/engine/backend.h"
#include "src/gpu/samplers.h"

#include <memory>
#include <string>
#include <vector>

namespace hpm {

struct CudaOptions {
  int device = 0;
  ImageFormat format = ImageFormat::kByte;
  int log_tile_width = 3;        // see pixel_tiles.h
  double launch_seconds = 0.03;  // aimed at; see band_planner.h
};

class CudaBackend : public Backend {
 public:
  // Longest launch so far, seconds.
  virtual double longest_launch() const = 0;
};

// Throws GpuError(kDevice) if the device cannot be used,
// GpuError(kOutOfResources) if it has no memory left; so do all methods.
std::unique_ptr<CudaBackend> MakeCudaBackend(const CudaOptions& options);

}  // namespace hpm
