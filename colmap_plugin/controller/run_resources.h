// What a run computes with: its backends, how many images are in flight and the
// cache of inputs, as far as memory allows.
#pragma once

#include "colmap_plugin/controller/input_cache.h"
#include "colmap_plugin/options/options.h"
#include "colmap_plugin/workspace/problem.h"
#include "src/base/log.h"
#include "src/cpu/cpu_target.h"
#include "src/engine/worker_pool.h"

#include <memory>
#include <string>
#include <vector>

namespace hpm {

struct RunResources {
  std::unique_ptr<WorkerPool> workers;
  std::unique_ptr<InputCache> inputs;
  std::string backend_name;  // for the run record
};

// Says in the log what it chose. The workspace must outlive the result. Throws
// Error(kDevice) if a GPU is demanded and none can be used,
// Error(kOutOfResources) if one image does not fit into memory.
RunResources OpenResources(const Workspace& workspace,
                           const std::vector<StereoProblem>& problems,
                           const ControllerOptions& options,
                           const CpuTarget& target,
                           int num_threads,
                           const LogSink& log);

}  // namespace hpm
