#include "colmap_plugin/controller/worker_pool.h"

#include "colmap_plugin/controller/work_queue.h"
#include "cuda/gpu_error.h"

#include <string>
#include <utility>

namespace hpm {

WorkerPool::WorkerPool(std::unique_ptr<Backend> cpu,
                       std::vector<std::unique_ptr<Backend>> gpus,
                       MakeRunner make_runner,
                       bool may_fall_back,
                       LogSink log)
    : cpu_(std::move(cpu)),
      cpu_runner_(make_runner(cpu_.get())),
      may_fall_back_(may_fall_back),
      log_(std::move(log)) {
  for (std::unique_ptr<Backend>& gpu : gpus) {
    alive_.push_back(static_cast<int>(gpus_.size()));
    std::unique_ptr<StageRunner> runner = make_runner(gpu.get());
    gpus_.push_back({std::move(gpu), std::move(runner)});
  }
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
  std::vector<int> cpu = {0};
  RunWorkQueue(left,
               &cpu,
               {[&](int, int problem) { compute(cpu_runner_.get(), problem); },
                [](int, const Error&) { return false; }});
}

}  // namespace hpm
