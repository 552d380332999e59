#include "src/engine/work_queue.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>

namespace hpm {
namespace {

class WorkQueue {
 public:
  WorkQueue(const std::vector<int>& items, const WorkQueueRules& rules)
      : rules_(rules), items_(items.begin(), items.end()) {}

  // The life of a worker; false: it gave up.
  bool Serve(int worker) {
    for (;;) {
      int item;
      if (!Take(&item)) return true;
      try {
        rules_.work(worker, item);
      } catch (const Error& error) {
        const std::lock_guard<std::mutex> lock(mutex_);
        if (failure_ == nullptr && rules_.gives_up(worker, error)) {
          items_.push_front(item);
          --num_running_;
          changed_.notify_all();
          return false;
        }
        Fail();
        return true;
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex_);
        Fail();
        return true;
      }
      const std::lock_guard<std::mutex> lock(mutex_);
      --num_running_;
      changed_.notify_all();
    }
  }

  std::vector<int> Finish() const {
    if (failure_ != nullptr) std::rethrow_exception(failure_);
    return {items_.begin(), items_.end()};
  }

 private:
  // Waits while another worker may still give its item back.
  bool Take(int* item) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait(lock, [this] {
      return failure_ != nullptr || !items_.empty() || num_running_ == 0;
    });
    if (failure_ != nullptr || items_.empty()) return false;
    *item = items_.front();
    items_.pop_front();
    ++num_running_;
    return true;
  }

  void Fail() {
    if (failure_ == nullptr) failure_ = std::current_exception();
    --num_running_;
    changed_.notify_all();
  }

  const WorkQueueRules& rules_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<int> items_;
  int num_running_ = 0;
  std::exception_ptr failure_;
};

}  // namespace

std::vector<int> RunWorkQueue(const std::vector<int>& items,
                              std::vector<int>* workers,
                              const WorkQueueRules& rules) {
  WorkQueue queue(items, rules);
  std::vector<char> stays(workers->size(), 1);
  std::vector<std::thread> threads;
  const auto serve = [&](size_t i) { stays[i] = queue.Serve((*workers)[i]); };
  for (size_t i = 1; i < workers->size(); ++i) {
    try {
      threads.emplace_back(serve, i);
    } catch (const std::system_error&) {
      break;  // The system grants no more; those there are do the work.
    }
  }
  if (!workers->empty()) serve(0);
  for (std::thread& thread : threads) thread.join();
  // Whoever had no thread takes over if the others gave up.
  for (size_t i = 1 + threads.size(); i < workers->size(); ++i) serve(i);
  std::vector<int> remaining;
  for (size_t i = 0; i < workers->size(); ++i) {
    if (stays[i]) remaining.push_back((*workers)[i]);
  }
  *workers = remaining;
  return queue.Finish();
}

}  // namespace hpm
