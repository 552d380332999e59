// Stands in for oneTBB under the thread sanitizer (CMake preset "tsan" puts
// this folder before the system's headers). The packaged libtbb is not
// instrumented: the sanitizer does not see how it hands tasks to threads and
// takes every hand-over for a race, also those of our own data; suppressing
// reports with TBB in the stack would hide ours, since all our loops run below
// TBB. Here threads that the sanitizer understands run the same loop bodies, so
// that a report is a race of ours.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>

#include <tbb/blocked_range.h>

namespace tbb {

struct simple_partitioner {};

// Chunks of the range's grain size, taken in turn by two threads. Relaxed, so
// that taking a chunk orders nothing between the threads.
template <class Index, class Body>
void parallel_for(const blocked_range<Index>& range,
                  const Body& body,
                  const simple_partitioner& = {}) {
  std::atomic<Index> next{range.begin()};
  const Index step = static_cast<Index>(range.grainsize());
  const auto work = [&] {
    for (;;) {
      const Index begin = next.fetch_add(step, std::memory_order_relaxed);
      if (begin >= range.end()) return;
      body(blocked_range<Index>(begin, std::min(begin + step, range.end())));
    }
  };
  std::thread other(work);
  work();
  other.join();
}

}  // namespace tbb
