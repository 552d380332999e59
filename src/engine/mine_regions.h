// Priors for the regions of the reference image without texture, mined from the
// points on which the views agree. A plane must have evidence of its own: all
// views that follow a prior confirm each other, right or wrong.
#pragma once

#include "src/engine/pass.h"
#include "src/engine/plane_evidence.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/weak_regions.h"

#include <vector>

namespace hpm {

// All empty where there is no region without texture or no source has a depth
// map.
struct MinedRegions {
  std::vector<Plane> priors;  // per pixel, distance 0: none
  // Per pixel: inside a region without texture, farther than kRimWidth from
  // anything else, and no believed plane explains it.
  std::vector<bool> unexplained;
  std::vector<float> agreement;  // per label, the share on which views agree
};

// `regions` and `map` are the reference's. `key` identifies the pass in the
// random numbers.
MinedRegions MineRegions(const ViewSet& views,
                         const WeakRegions& regions,
                         const MethodParams& params,
                         const HypothesisMap& map,
                         uint64_t key,
                         const ScorePlanes& score);

// Whether a candidate may lead its region. Either the images match better on it
// than beside it; or they do not contradict it and its points say so: they are
// no line, and much of the rim lies on it and little behind it, or it explains
// most of the inside.
bool IsBelievable(const RegionPlane& plane, const PlaneEvidence& evidence);

}  // namespace hpm
