// What the user is told when a run is over.
#pragma once

#include "colmap_plugin/controller/controller.h"

#include <string>
#include <vector>

namespace hpm {

// Images computed, kept and failed, share of pixels with a depth, time, memory,
// where the maps are and the fusion command that comes next.
std::vector<std::string> SummaryLines(const ControllerOptions& options,
                                      const RunSummary& summary);

}  // namespace hpm
