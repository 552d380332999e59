// What `hpm_mvs patch_match_stereo` does once its options are known: the run,
// and the page about it.
#pragma once

#include "colmap_plugin/controller/controller.h"

namespace hpm {

// Throws what PatchMatchController::Run() throws. A page that cannot be written
// is a warning.
RunSummary RunStereo(const ControllerOptions& options,
                     const LogSink& log,
                     const ProgressSink& progress,
                     const CancelToken& cancel);

}  // namespace hpm
