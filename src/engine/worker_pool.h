// The backends of a run, each with the memory of one image in flight, and what
// happens when a GPU gives up: its image goes to the others, the last resort is
// the CPU.
#pragma once

#include "src/base/log.h"
#include "src/engine/backend.h"
#include "src/image/hypothesis_map.h"

#include <functional>
#include <memory>
#include <vector>

namespace hpm {

// Works on one problem at a time.
struct Worker {
  std::unique_ptr<Backend> backend;
  HypothesisMap map;  // its memory stays for the next problem
};

class WorkerPool {
 public:
  // Without GPUs the CPU computes, one image in flight per entry of `cpus`.
  // may_fall_back: whether it does so too when no GPU is left.
  WorkerPool(std::vector<std::unique_ptr<Backend>> cpus,
             std::vector<std::unique_ptr<Backend>> gpus,
             bool may_fall_back,
             LogSink log);
  // One image in flight.
  explicit WorkerPool(std::unique_ptr<Backend> backend);

  // Computes all problems; `compute` may be called from several threads at
  // once. A GPU that runs out of memory or fails is given up and its problem
  // computed by another worker. Throws what `compute` throws otherwise.
  void Run(const std::vector<int>& problems,
           const std::function<void(Worker* worker, int problem)>& compute);

 private:
  std::vector<Worker> cpus_;
  std::vector<Worker> gpus_;
  std::vector<int> alive_;  // indices into gpus_
  bool may_fall_back_;
  LogSink log_;
};

}  // namespace hpm
