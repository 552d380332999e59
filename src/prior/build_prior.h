// The prior of one level: what a prior-assisted pass needs.
#pragma once

#include "src/image/gray_image.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/planar_prior.h"

#include <vector>

namespace hpm {

// One plane per pixel of LevelCamera(camera, level), distance 0 = none.
std::vector<Plane> BuildLevelPrior(const HypothesisMap& map,
                                   const Camera& camera,
                                   int level,
                                   const PriorRange& range);

// One plane per pixel of `map`, distance 0 = none. `guide` is the reference
// image.
std::vector<Plane> BuildPrior(const HypothesisMap& map,
                              const Camera& camera,
                              const GrayImage& guide,
                              int level,
                              const PriorRange& range);

}  // namespace hpm
