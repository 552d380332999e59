// Cooperative cancellation: a signal handler sets the token, workers poll it
// between tiles and rows.
#pragma once

#include "src/base/error.h"

#include <atomic>

namespace hpm {

class CancelToken {
 public:
  CancelToken() = default;
  // Also cancelled when `outer` is, which must outlive this token.
  explicit CancelToken(const CancelToken* outer) : outer_(outer) {}

  // Async-signal-safe.
  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const {
    return cancelled_.load(std::memory_order_relaxed) ||
           (outer_ != nullptr && outer_->cancelled());
  }

  // Throws Error(kInterrupted) once Cancel() was called.
  void ThrowIfCancelled() const {
    if (cancelled()) throw Error(ErrorCode::kInterrupted, "interrupted");
  }

 private:
  std::atomic<bool> cancelled_{false};
  const CancelToken* outer_ = nullptr;
};

}  // namespace hpm
