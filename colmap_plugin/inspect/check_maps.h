// `hpm_mvs check`: what is wrong with the maps of a workspace, by the plan of
// the run that would make them.
#pragma once

#include "colmap_plugin/inspect/check_findings.h"
#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

namespace hpm {

// Looks at everything and, with `fix`, removes what is damaged, with its stamp;
// what cannot be read may be good and stays. Without, nothing is changed.
// Throws Error(kBadInput) for a workspace that no run could use or a file that
// cannot be removed, Error(kLocked) if it is to remove and a run is at work,
// Error(kInterrupted).
MapCheck CheckMaps(const ControllerOptions& options,
                   bool fix,
                   const LogSink& log,
                   const CancelToken& cancel);

}  // namespace hpm
