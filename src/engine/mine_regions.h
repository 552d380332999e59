// Priors for the regions of the reference image without texture, mined from the
// points on which the views agree.
#pragma once

#include "src/engine/pass.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"

#include <vector>

namespace hpm {

// One plane per pixel, distance 0 = none; empty where there is no such region
// or no source has a depth map. `map` is the reference's. `key` identifies the
// pass in the random numbers.
std::vector<Plane> MineRegions(const ViewSet& views,
                               const MethodParams& params,
                               const HypothesisMap& map,
                               uint64_t key);

}  // namespace hpm
