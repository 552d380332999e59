// Pixels for which nothing is left to decide, so that updates pass them over
// (PixelState::settled): deep inside a region without texture, where windows
// see nothing else, and on a surface that is known already.
#pragma once

#include "src/engine/pass.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/weak_regions.h"

#include <cstdint>
#include <vector>

namespace hpm {

// Those where the planes of the map, which came up from a coarser level, go on
// in each other: this level sees no more there. Where they do not, no plane
// explains them, and only that every view searches on by itself keeps the views
// from agreeing on something wrong.
std::vector<uint8_t> SettledByCoarserLevel(const ViewSet& views,
                                           const WeakRegions& regions,
                                           const MethodParams& params,
                                           const HypothesisMap& map);

// Those whose plane lies on the prior of their region. They take the prior: it
// is the mean of many points, their own plane that of one. Sets map->settled;
// touches the map.
void SettleOnPriors(const ViewSet& views,
                    const WeakRegions& regions,
                    const MethodParams& params,
                    HypothesisMap* map);

}  // namespace hpm
