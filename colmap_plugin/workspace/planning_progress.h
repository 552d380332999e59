// A line now and then where planning takes long, so that nobody takes a run for
// dead before its first image.
#pragma once

#include "src/base/cancel.h"
#include "src/base/log.h"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace hpm {

class PlanningProgress {
 public:
  // "<what>: 120 of 200 images" every `interval`. Keeps references to log and
  // cancel; the log may be empty.
  PlanningProgress(
      std::string what,
      size_t num_images,
      const LogSink& log,
      const CancelToken& cancel,
      std::chrono::milliseconds interval = std::chrono::seconds(5));

  // After each image, from any thread. Throws Error(kInterrupted).
  void Count();

 private:
  const std::string what_;
  const size_t num_images_;
  const LogSink& log_;
  const CancelToken& cancel_;
  const std::chrono::milliseconds interval_;
  std::atomic<size_t> num_done_{0};
  std::mutex mutex_;
  std::chrono::steady_clock::time_point next_;
};

}  // namespace hpm
