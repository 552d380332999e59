// What stops a share of a run (run_share.h) that others have to do something
// for first, or that there is none of.
#pragma once

#include "colmap_plugin/controller/run_share.h"
#include "colmap_plugin/controller/stages.h"

namespace hpm {

// Throws Error(kUsage) if the run has no such stage, Error(kNotReady) if there
// is nothing to finish yet.
void CheckShare(const RunShare& share, const StagePlan& plan);

// Throws Error(kNotReady), naming images, if maps are missing that this process
// reads in the stage. A whole run goes on without what failed.
void CheckInputs(const RunShare& share, const StagePlan& plan, int stage);

}  // namespace hpm
