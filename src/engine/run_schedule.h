// A whole run: all stages of a schedule over all problems, coarse to fine. The
// one place that says which stage follows which, with whose maps.
#pragma once

#include "src/base/cancel.h"
#include "src/engine/image_store.h"
#include "src/engine/map_store.h"
#include "src/engine/run_spec.h"
#include "src/engine/worker_pool.h"

#include <functional>

namespace hpm {

struct RunProgress {
  int stage = 0;
  int problem = -1;      // -1: the stage is finished
  int number = 0;        // of the problem, from 1, among those of the stage
  int num_problems = 0;  // that have to be computed in this stage
  double fraction = 0;   // of the whole run, 0..1, by estimated work
};

// What a caller may want to know or do meanwhile; each may be empty. Calls come
// from several threads, one at a time.
struct RunEvents {
  const CancelToken* cancel = nullptr;
  std::function<void(const RunProgress&)> started;  // before a problem
  std::function<void(const RunProgress&)> progress;
  // A problem whose input is bad (Error(kBadInput)). It is left out of the
  // later stages and the others go on without its maps. Where this is empty,
  // the error ends the run.
  std::function<void(int stage, int problem, const Error& error)> failed;
};

// Between two stages lies a barrier: a stage reads maps of reference and
// sources that the stage before has made. What the store does not need is not
// computed: a store that knows what an earlier run or another process made
// makes this a resumed run, or one share of a stage.
//
// Throws UnreadableImages, Error(kInterrupted), and what stores and backends
// throw; Error(kUsage) for a spec that cannot be run and for pictures of
// another size than their cameras.
void RunSchedule(const RunSpec& spec,
                 ImageStore* images,
                 MapStore* maps,
                 WorkerPool* workers,
                 const RunEvents& events);

}  // namespace hpm
