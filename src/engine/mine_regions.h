// Priors for the regions of the reference image without texture, mined from the
// points on which the views agree.
#pragma once

#include "src/engine/backend.h"

#include <vector>

namespace hpm {

// One plane per pixel, distance 0 = none; empty where there is no such region
// or no source has a depth map. `map` is the reference's, `views` were handed
// to `backend`. `key` identifies the pass in the random numbers.
std::vector<Plane> MineRegions(Backend* backend,
                               const ViewSet& views,
                               const MethodParams& params,
                               const HypothesisMap& map,
                               uint64_t key,
                               const RunControl& control);

}  // namespace hpm
