#include "python/src/background_run.h"

#include "src/base/error.h"
#include "src/base/threads.h"

#include <chrono>
#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <new>
#include <system_error>
#include <thread>
#include <utility>

#include <nanobind/nanobind.h>

namespace nb = nanobind;

namespace hpm {
namespace {

// Python's handlers of signals run when the calling thread asks for them.
constexpr auto kSignalInterval = std::chrono::milliseconds(50);

class BackgroundRun {
 public:
  explicit BackgroundRun(
      const std::function<void(const CancelToken&, const Post&)>& work)
      : thread_([this, &work] { Work(work); }) {}

  void Wait() {
    for (bool is_over = false; !is_over;) {
      std::function<void()> posted;
      {
        const nb::gil_scoped_release release;
        is_over = Next(&posted);
      }
      if (raised_) continue;
      try {
        if (PyErr_CheckSignals() != 0) throw nb::python_error();
        if (posted) posted();
      } catch (...) {
        raised_ = std::current_exception();
        cancel_.Cancel();
      }
    }
    {
      const nb::gil_scoped_release release;
      thread_.join();
    }
    if (raised_) std::rethrow_exception(std::exchange(raised_, nullptr));
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  void Work(const std::function<void(const CancelToken&, const Post&)>& work) {
    try {
      work(cancel_,
           [this](std::function<void()> piece) { Add(std::move(piece)); });
    } catch (const Error&) {
      failure_ = std::current_exception();
    } catch (const std::bad_alloc&) {
      failure_ = std::make_exception_ptr(
          Error(ErrorCode::kOutOfResources,
                "out of memory; lower cache_size (GiB) or max_image_size "
                "(pixels)"));
    } catch (const std::exception& error) {
      failure_ =
          std::make_exception_ptr(Error(ErrorCode::kFailure, error.what()));
    }
    const std::lock_guard<std::mutex> lock(mutex_);
    is_finished_ = true;
    changed_.notify_all();
  }

  void Add(std::function<void()> piece) {
    const std::lock_guard<std::mutex> lock(mutex_);
    posted_.push_back(std::move(piece));
    changed_.notify_all();
  }

  // Waits a while for something to do; true: there is and will be nothing.
  bool Next(std::function<void()>* posted) {
    std::unique_lock<std::mutex> lock(mutex_);
    changed_.wait_for(lock, kSignalInterval, [this] {
      return is_finished_ || !posted_.empty();
    });
    if (posted_.empty()) return is_finished_;
    *posted = std::move(posted_.front());
    posted_.pop_front();
    return false;
  }

  CancelToken cancel_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void()>> posted_;
  bool is_finished_ = false;
  std::exception_ptr failure_;  // of the work
  std::exception_ptr raised_;   // in the calling thread
  std::thread thread_;          // the last: it uses all of the above
};

}  // namespace

void RunInBackground(
    const std::function<void(const CancelToken&, const Post&)>& work) {
  std::unique_ptr<BackgroundRun> run;
  try {
    run = std::make_unique<BackgroundRun>(work);
  } catch (const std::system_error&) {
    throw NoThreadError();
  }
  run->Wait();
}

}  // namespace hpm
