// One stage of one problem: the views it matches, the hypotheses it starts
// from, its passes, and for a final stage the filter.
#pragma once

#include "src/engine/image_store.h"
#include "src/engine/map_store.h"
#include "src/engine/run_spec.h"
#include "src/engine/worker_pool.h"

namespace hpm {

// Reads what the stage needs from the stores and writes what it made. Throws
// UnreadableImages, Error(kInterrupted) when cancelled, and what the stores and
// the backend throw.
void RunStage(const RunSpec& spec,
              int stage,
              int problem,
              ImageStore* images,
              MapStore* maps,
              Worker* worker,
              const RunControl& control);

}  // namespace hpm
