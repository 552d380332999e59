// `hpm_mvs plan`: what a run would do and need, and all that would stop it.
#pragma once

#include "colmap_plugin/inspect/sample_run.h"
#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/error.h"
#include "src/base/log.h"

#include <string>
#include <vector>

namespace hpm {

struct RunPlan {
  std::vector<std::string> lines;     // what is known, for people
  std::vector<std::string> problems;  // one line each, in the run's order
  // The run's: of its first problem, kPartial if some image cannot be computed.
  int exit_code = 0;
};

// Makes all checks of a run, going on after one that fails where it can, and
// changes nothing in the workspace: no lock is taken, no folder made. The time
// is that of this planning and what follows from runs of one image at a reduced
// size, for about sample_seconds (0: not at all), in a folder for temporary
// files. Throws Error(kInterrupted).
RunPlan PlanRun(const ControllerOptions& options,
                double sample_seconds,
                const LogSink& log,
                const CancelToken& cancel);

// Of a run with so much work (PlannedRun::Work()), which plans as this plan
// did.
std::string TimeLine(double work,
                     double planning_seconds,
                     const Sample& sample);

}  // namespace hpm
