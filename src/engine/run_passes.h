// Runs the passes of one stage for one reference image on a backend.
#pragma once

#include "src/engine/backend.h"
#include "src/engine/schedule.h"

#include <map>
#include <string>

namespace hpm {

// Wall seconds per phase: "basic", "prior", "geometric", "filter", ...
using PhaseTimes = std::map<std::string, double>;

// `map` has the size of the reference and holds the hypotheses to start from
// (distance 0: none); `views` the images, and for a geometric stage the depth
// of the sources, at the stage's level.
void RunPasses(Backend* backend,
               const ViewSet& views,
               const Schedule& schedule,
               const StageSpec& stage,
               const MethodParams& params,
               const RunControl& control,
               HypothesisMap* map,
               PhaseTimes* times);

}  // namespace hpm
