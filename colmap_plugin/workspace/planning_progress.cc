#include "colmap_plugin/workspace/planning_progress.h"

#include <utility>

#include <fmt/format.h>

namespace hpm {

PlanningProgress::PlanningProgress(std::string what,
                                   size_t num_images,
                                   const LogSink& log,
                                   const CancelToken& cancel,
                                   std::chrono::milliseconds interval)
    : what_(std::move(what)),
      num_images_(num_images),
      log_(log),
      cancel_(cancel),
      interval_(interval),
      next_(std::chrono::steady_clock::now() + interval) {}

void PlanningProgress::Count() {
  cancel_.ThrowIfCancelled();
  const size_t num_done = ++num_done_;
  if (!log_) return;
  // Who does not get it leaves the line to another.
  const std::unique_lock<std::mutex> lock(mutex_, std::try_to_lock);
  if (!lock.owns_lock()) return;
  const auto now = std::chrono::steady_clock::now();
  if (now < next_) return;
  next_ = now + interval_;
  log_(LogLevel::kInfo,
       fmt::format("{}: {} of {} images", what_, num_done, num_images_));
}

}  // namespace hpm
