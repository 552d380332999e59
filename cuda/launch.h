// Starting kernels; the arguments are plain, the memory is the card's. All
// return at once and throw GpuError(kDevice) if the launch is refused.
#pragma once

#include "cuda/warp.h"
#include "src/core/sweep.h"
#include "src/gpu/device_problem.h"
#include "src/gpu/samplers.h"

#include <cuda_runtime_api.h>

namespace hpm {

struct SweepLaunch {
  const DeviceProblem* problem;  // of the host; params.geometric set
  Sweep sweep;
  PixelState state;
  uint32_t* consistent;
  Band band;
  unsigned long long* num_evaluations;  // added to
};

void LaunchTextureSweep(const SweepLaunch& launch, cudaStream_t stream);
void LaunchQuadSweep(const SweepLaunch& launch, cudaStream_t stream);
// Those that need no matching cost.
void LaunchPlainSweep(const SweepLaunch& launch, cudaStream_t stream);

// costs[i]: of planes[i], from all views; both in the card's memory.
struct ScoreLaunch {
  const DeviceProblem* problem;  // of the host
  const PixelPlane* planes;
  size_t num_planes;
  float* costs;
};

void LaunchTextureScore(const ScoreLaunch& launch, cudaStream_t stream);
void LaunchQuadScore(const ScoreLaunch& launch, cudaStream_t stream);

// planes[pixel of ref] from those of a coarser level; see
// src/core/upsample_plane.h.
void LaunchUpsample(const DeviceProblem& problem,
                    const Plane* low,
                    int level,
                    Plane* planes,
                    cudaStream_t stream);

// See texel_image.h.
void LaunchPackTexels(const uint8_t* grey,
                      int width,
                      int height,
                      uint32_t* texels,
                      cudaStream_t stream);

// The image at the size of the layers, the border repeated.
void LaunchFillLayer(const uint8_t* grey,
                     int width,
                     int height,
                     int layer_width,
                     int layer_height,
                     uint8_t* layer,
                     cudaStream_t stream);

}  // namespace hpm
