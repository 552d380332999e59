// See parallel_for.h in this folder.
#pragma once

#include <map>
#include <mutex>
#include <thread>
#include <utility>

namespace tbb {

template <class Value>
class enumerable_thread_specific {
 public:
  explicit enumerable_thread_specific(Value first = {})
      : first_(std::move(first)) {}
  Value& local() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return values_.try_emplace(std::this_thread::get_id(), first_)
        .first->second;
  }

 private:
  const Value first_;
  std::mutex mutex_;
  std::map<std::thread::id, Value> values_;
};

}  // namespace tbb
