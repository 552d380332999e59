// The threads that compute: as many as are wanted, or as the system grants.
#pragma once

#include "src/base/log.h"

#include <tbb/global_control.h>

namespace hpm {

// Must live as long as anything computes. oneTBB ends the program when it
// cannot start a thread; so the threads are counted first, and oneTBB starts
// all of its own at once, while nothing else can take them away.
class ThreadSupply {
 public:
  // `wanted` <= 0: one for each core. Warns where fewer are to be had; throws
  // Error(kOutOfResources) where there is none but the caller's.
  ThreadSupply(int wanted, const LogSink& log);

  int num_threads() const { return num_threads_; }

 private:
  int num_threads_;  // before limit_, which is made from it
  tbb::global_control limit_;
};

}  // namespace hpm
