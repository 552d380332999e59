// The backends of a run, each with a stage runner of its own, and what happens
// when a GPU gives up: its image goes to the others, the last resort is the
// CPU.
#pragma once

#include "colmap_plugin/controller/stage_runner.h"
#include "src/base/log.h"
#include "src/engine/backend.h"

#include <functional>
#include <memory>
#include <vector>

namespace hpm {

class WorkerPool {
 public:
  using MakeRunner =
      std::function<std::unique_ptr<StageRunner>(Backend* backend)>;

  // Without GPUs the CPU computes, one image in flight per entry of `cpus`.
  // may_fall_back: whether it does so too when no GPU is left.
  WorkerPool(std::vector<std::unique_ptr<Backend>> cpus,
             std::vector<std::unique_ptr<Backend>> gpus,
             MakeRunner make_runner,
             bool may_fall_back,
             LogSink log);

  // Computes all problems; `compute` may be called from several threads at
  // once. A GPU that runs out of memory or fails is given up and its problem
  // computed by another worker. Throws what `compute` throws otherwise.
  void Run(
      const std::vector<int>& problems,
      const std::function<void(StageRunner* runner, int problem)>& compute);

 private:
  struct Worker {
    std::unique_ptr<Backend> backend;
    std::unique_ptr<StageRunner> runner;
  };

  std::vector<Worker> cpus_;
  std::vector<Worker> gpus_;
  std::vector<int> alive_;  // indices into gpus_
  bool may_fall_back_;
  LogSink log_;
};

}  // namespace hpm
