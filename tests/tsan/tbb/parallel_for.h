// Stands in for oneTBB under the thread sanitizer (CMake preset "tsan" puts
// this folder before the system's headers). The packaged libtbb is not
// instrumented: the sanitizer does not see how it hands tasks to threads and
// takes every hand-over for a race, also those of our own data; suppressing
// reports with TBB in the stack would hide ours, since all our loops run below
// TBB. Here threads that the sanitizer understands run the same loop bodies, so
// that a report is a race of ours. Neither Ninja nor ccache notices a header
// that is added here and hides the system's: build anew, with an empty cache.
#pragma once

#include <algorithm>
#include <atomic>
#include <exception>
#include <thread>

#include <tbb/blocked_range.h>

namespace tbb {

struct simple_partitioner {};

// Runs work() in two threads and passes on what one of them throws.
template <class Work>
void RunTwice(const Work& work) {
  std::exception_ptr failures[2];
  const auto guarded = [&](int i) {
    try {
      work();
    } catch (...) {
      failures[i] = std::current_exception();
    }
  };
  std::thread other(guarded, 1);
  guarded(0);
  other.join();
  for (const std::exception_ptr& failure : failures) {
    if (failure) std::rethrow_exception(failure);
  }
}

// Chunks of the range's grain size, taken in turn by two threads. Relaxed, so
// that taking a chunk orders nothing between the threads.
template <class Index, class Body>
void parallel_for(const blocked_range<Index>& range,
                  const Body& body,
                  const simple_partitioner& = {}) {
  std::atomic<Index> next{range.begin()};
  const Index step = static_cast<Index>(range.grainsize());
  RunTwice([&] {
    for (;;) {
      const Index begin = next.fetch_add(step, std::memory_order_relaxed);
      if (begin >= range.end()) return;
      body(blocked_range<Index>(begin, std::min(begin + step, range.end())));
    }
  });
}

template <class Index, class Body>
void parallel_for(Index first,
                  Index last,
                  const Body& body,
                  const simple_partitioner& = {}) {
  if (first >= last) return;
  parallel_for(blocked_range<Index>(first, last),
               [&](const blocked_range<Index>& range) {
                 for (Index i = range.begin(); i < range.end(); ++i) body(i);
               });
}

}  // namespace tbb
