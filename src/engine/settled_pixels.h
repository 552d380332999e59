// Pixels without texture need few visits or none (PixelState::visits): what
// more visits find there is the luck of a window. None is needed by those that
// are settled: deep inside a region, where windows see nothing else, and on a
// surface that is known already. In half visits a pixel that is not visited may
// still follow another one.
#pragma once

#include "src/engine/pass.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/weak_regions.h"

#include <cstdint>
#include <vector>

namespace hpm {

// For the search of the coarsest level, where nothing is settled: as often as
// any other plain pixel, however many iterations textured ones are given.
std::vector<uint8_t> VisitsByTexture(const WeakRegions& regions);

// For the search of a level whose planes came up from a coarser one. Settled
// are those pixels where they go on in each other: this level sees no more
// there. Where they do not, no plane explains them, and only that every view
// searches on by itself keeps the views from agreeing on something wrong.
std::vector<uint8_t> VisitsBelowCoarserLevel(const ViewSet& views,
                                             const WeakRegions& regions,
                                             const MethodParams& params,
                                             const HypothesisMap& map);

// For a geometric pass. Settled are those whose plane lies on the prior of
// their region. They take the prior: it is the mean of many points, their own
// plane that of one. Sets map->visits; touches the map.
void SettleOnPriors(const ViewSet& views,
                    const WeakRegions& regions,
                    const MethodParams& params,
                    HypothesisMap* map);

}  // namespace hpm
