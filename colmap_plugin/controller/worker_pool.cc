#include "colmap_plugin/controller/worker_pool.h"

#include "colmap_plugin/controller/work_queue.h"
#include "cuda/gpu_error.h"

#include <numeric>
#include <string>
#include <utility>

namespace hpm {

WorkerPool::WorkerPool(std::vector<std::unique_ptr<Backend>> cpus,
                       std::vector<std::unique_ptr<Backend>> gpus,
                       MakeRunner make_runner,
                       bool may_fall_back,
                       LogSink log)
    : may_fall_back_(may_fall_back), log_(std::move(log)) {
  const auto hire = [&](std::vector<std::unique_ptr<Backend>>* backends,
                        std::vector<Worker>* workers) {
    for (std::unique_ptr<Backend>& backend : *backends) {
      std::unique_ptr<StageRunner> runner = make_runner(backend.get());
      workers->push_back({std::move(backend), std::move(runner)});
    }
  };
  hire(&cpus, &cpus_);
  hire(&gpus, &gpus_);
  alive_.resize(gpus_.size());
  std::iota(alive_.begin(), alive_.end(), 0);
}

void WorkerPool::Run(
    const std::vector<int>& problems,
    const std::function<void(StageRunner* runner, int problem)>& compute) {
  std::vector<int> left = problems;
  if (!alive_.empty()) {
    size_t num_alive = alive_.size();
    left = RunWorkQueue(
        problems,
        &alive_,
        {[&](int worker, int problem) {
           compute(gpus_[worker].runner.get(), problem);
         },
         [&](int worker, const Error& error) {
           // A full disk would be full for the others, too.
           if (dynamic_cast<const GpuError*>(&error) == nullptr) return false;
           const bool last = num_alive == 1;
           if (last && !may_fall_back_) return false;
           --num_alive;
           gpus_[worker].runner.reset();
           gpus_[worker].backend.reset();  // its memory is for the others
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
  RunWorkQueue(left,
               &cpus,
               {[&](int worker, int problem) {
                  compute(cpus_[worker].runner.get(), problem);
                },
                [](int, const Error&) { return false; }});
}

}  // namespace hpm
