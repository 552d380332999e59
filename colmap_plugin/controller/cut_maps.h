// Depth ranges given by hand and maps that users see, but later stages read
// first.
#pragma once

#include "colmap_plugin/controller/stages.h"

#include <vector>

namespace hpm {

// Takes the depths outside the published range out of the public maps of all
// stages but the last, which is cut already. Surfaces outside had to be found
// until then, see DepthRanges; so call this when the run is complete.
void CutInputMaps(const Workspace& workspace,
                  const std::vector<StereoProblem>& problems,
                  const StagePlan& plan);

}  // namespace hpm
