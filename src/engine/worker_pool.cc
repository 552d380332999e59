#include "src/engine/worker_pool.h"

#include "src/engine/gpu_error.h"
#include "src/engine/work_queue.h"

#include <numeric>
#include <string>
#include <utility>

namespace hpm {

WorkerPool::WorkerPool(std::vector<std::unique_ptr<Backend>> cpus,
                       std::vector<std::unique_ptr<Backend>> gpus,
                       bool may_fall_back,
                       LogSink log)
    : alive_(gpus.size()), may_fall_back_(may_fall_back), log_(std::move(log)) {
  for (std::unique_ptr<Backend>& cpu : cpus)
    cpus_.push_back({std::move(cpu), {}});
  for (std::unique_ptr<Backend>& gpu : gpus)
    gpus_.push_back({std::move(gpu), {}});
  std::iota(alive_.begin(), alive_.end(), 0);
}

WorkerPool::WorkerPool(std::unique_ptr<Backend> backend)
    : may_fall_back_(false) {
  cpus_.push_back({std::move(backend), {}});
}

void WorkerPool::Run(
    const std::vector<int>& problems,
    const std::function<void(Worker* worker, int problem)>& compute) {
  std::vector<int> left = problems;
  if (!alive_.empty()) {
    size_t num_alive = alive_.size();
    left = RunWorkQueue(
        problems,
        &alive_,
        {[&](int worker, int problem) { compute(&gpus_[worker], problem); },
         [&](int worker, const Error& error) {
           // A full disk would be full for the others, too.
           if (dynamic_cast<const GpuError*>(&error) == nullptr) return false;
           const bool last = num_alive == 1;
           if (last && !may_fall_back_) return false;
           --num_alive;
           gpus_[worker] = {};  // its memory is for the others
           log_(LogLevel::kWarning,
                std::string(error.what()) +
                    (last ? " (going on with the CPU)"
                          : " (going on with fewer images in flight)"));
           return true;
         }});
  }
  if (left.empty()) return;
  std::vector<int> cpus(cpus_.size());
  std::iota(cpus.begin(), cpus.end(), 0);
  RunWorkQueue(
      left,
      &cpus,
      {[&](int worker, int problem) { compute(&cpus_[worker], problem); },
       [](int, const Error&) { return false; }});
}

}  // namespace hpm
