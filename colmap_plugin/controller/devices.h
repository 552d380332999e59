// Where a run computes: on the CPU, or on which GPUs with how many images in
// flight.
#pragma once

#include "colmap_plugin/options/options.h"
#include "cuda/cuda_devices.h"
#include "src/base/log.h"
#include "src/engine/backend.h"
#include "src/gpu/memory_estimate.h"

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace hpm {

// The cards an index list names, one entry per entry of the list: "-1" all,
// "0,1", repeats. Throws Error(kDevice) for an index without a card.
std::vector<int> ParseGpuIndex(const std::string& list, int num_devices);

// The machine's GPUs; tests bring their own.
struct GpuAccess {
  std::function<std::vector<CudaDevice>(std::string* why_none)> find;
  std::function<std::unique_ptr<Backend>(int device)> open;
};
GpuAccess RealGpus();

// One backend per image in flight, all on GPUs that passed the self-test; empty
// when the CPU is to compute. With --Hpm.device auto a GPU that cannot be used
// gives one line in the log; with cuda it throws Error(kDevice) or, for lack of
// memory, Error(kOutOfResources).
std::vector<std::unique_ptr<Backend>> OpenGpus(const ControllerOptions& options,
                                               const ProblemSize& largest,
                                               int num_images,
                                               int num_threads,
                                               const GpuAccess& gpus,
                                               const LogSink& log);

}  // namespace hpm
