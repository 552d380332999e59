// From the command line's options to the numbers of the algorithm.
#pragma once

#include "colmap_plugin/options/options.h"
#include "src/engine/run_spec.h"
#include "src/engine/schedule.h"

#include <optional>

namespace hpm {

MethodParams MakeMethodParams(const ControllerOptions& options);
ScheduleOptions MakeScheduleOptions(const ControllerOptions& options);

// None if the user wants none.
std::optional<MapFilter> MakeMapFilter(const ControllerOptions& options);

}  // namespace hpm
