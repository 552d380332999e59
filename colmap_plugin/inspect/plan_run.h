// `hpm_mvs plan`: what a run would do and need, and all that would stop it.
#pragma once

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

// Makes all checks of a run, going on after one that fails where it can. Takes
// nothing for granted: folders for the maps are made, a trial file is written.
// The time is measured by runs of one image at a reduced size, for about
// sample_seconds (0: not at all), in a folder for temporary files. Throws
// Error(kInterrupted).
RunPlan PlanRun(const ControllerOptions& options,
                double sample_seconds,
                const LogSink& log,
                const CancelToken& cancel);

}  // namespace hpm
