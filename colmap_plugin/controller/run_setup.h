// From options and workspace to the problems and levels of a run: for the run
// itself, and for all who want to know what it would do.
#pragma once

#include "colmap_plugin/options/options.h"
#include "colmap_plugin/workspace/model_overview.h"
#include "colmap_plugin/workspace/problem.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <vector>

namespace hpm {

// From the references, as ReadProblems() has them, to the problems of a run in
// the order in which it works them off: references first, behind them images
// that are only sources, where geometric stages need maps of these; both by
// overlap.
void CompleteProblems(const Workspace& workspace,
                      const ModelOverview& overview,
                      const ControllerOptions& options,
                      const LogSink& log,
                      const CancelToken& cancel,
                      std::vector<StereoProblem>* problems);

// --Hpm.num_levels, where the user leaves it to the method. The largest image
// of the workspace decides for all, so that all have the same stages, whichever
// of them a run computes.
void SetLevels(const Workspace& workspace, ControllerOptions* options);

}  // namespace hpm
