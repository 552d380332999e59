// From the command line's options to the numbers of the algorithm.
#pragma once

#include "colmap_plugin/options/options.h"
#include "src/core/consistency_filter.h"
#include "src/engine/schedule.h"

namespace hpm {

MethodParams MakeMethodParams(const ControllerOptions& options);
ScheduleOptions MakeScheduleOptions(const ControllerOptions& options);

// num_srcs: images used besides the reference; COLMAP lowers
// filter_min_num_consistent to it.
FilterParams MakeFilterParams(const PatchMatchStereoOptions& options,
                              int num_srcs);

}  // namespace hpm
