// Images shared out among workers: whoever is free takes the next one.
#pragma once

#include "src/base/error.h"

#include <functional>
#include <vector>

namespace hpm {

struct WorkQueueRules {
  // Computes an item; the first worker in the caller's thread, each other in
  // one of its own. Workers for whom no thread can be started wait until
  // those with threads are done.
  std::function<void(int worker, int item)> work;
  // Asked when work() throws Error: whether this worker gives up for good. Its
  // item then goes to another worker. Calls do not overlap.
  std::function<bool(int worker, const Error& error)> gives_up;
};

// Works off `items`, first come first served. Workers that give up are removed
// from *workers; items that are left when none remains are returned. Any other
// exception ends the queue once the running items are done, and is thrown
// again.
std::vector<int> RunWorkQueue(const std::vector<int>& items,
                              std::vector<int>* workers,
                              const WorkQueueRules& rules);

}  // namespace hpm
