// Runs the passes of a schedule for one reference image.
#pragma once

#include "src/engine/backend.h"
#include "src/engine/schedule.h"

#include <map>
#include <string>

namespace hpm {

// Wall seconds per phase: "basic", "prior", "geometric", "filter", ...
using PhaseTimes = std::map<std::string, double>;

// The photometric group: basic and prior passes, from random numbers on.
HypothesisMap EstimatePhotometric(Backend* backend,
                                  const ViewSet& views,
                                  const Schedule& schedule,
                                  const MethodParams& params,
                                  const RunControl& control,
                                  PhaseTimes* times);

// One geometric pass, in place; the sources' depth is in `views`.
void RefineGeometric(Backend* backend,
                     const ViewSet& views,
                     const Schedule& schedule,
                     const Pass& pass,
                     const MethodParams& params,
                     const RunControl& control,
                     HypothesisMap* map,
                     PhaseTimes* times);

}  // namespace hpm
