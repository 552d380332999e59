// Depth ranges given by hand and maps that users see, but later stages read
// first.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "src/base/cancel.h"

#include <vector>

namespace hpm {

// Takes the depths outside the published range out of the public maps of all
// stages but the last, which is cut already. Surfaces outside had to be found
// until then, see DepthRanges; so call this when the run is complete.
// Throws Error(kInterrupted, kLocked) between two maps.
void CutInputMaps(const Workspace& workspace,
                  const std::vector<StereoProblem>& problems,
                  const StagePlan& plan,
                  const RunLock& lock,
                  const CancelToken& cancel);

}  // namespace hpm
