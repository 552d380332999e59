#include "src/prior/build_prior.h"

#include "src/core/prior_term.h"
#include "src/prior/upsample_prior.h"

namespace hpm {

std::vector<Plane> BuildLevelPrior(const HypothesisMap& map,
                                   const Camera& camera,
                                   int level,
                                   const PriorRange& range) {
  const LevelMap reduced = MakeLevel(map, camera, level);
  return MakePlanarPrior(reduced.camera,
                         FindCrediblePoints(reduced, kCredibleCost),
                         range,
                         OutsideTriangles::kNearestPoints);
}

std::vector<Plane> BuildPrior(const HypothesisMap& map,
                              const Camera& camera,
                              const GrayImage& guide,
                              int level,
                              const PriorRange& range) {
  std::vector<Plane> planes = BuildLevelPrior(map, camera, level, range);
  if (level == 0) return planes;
  std::vector<Plane> prior;
  UpsamplePrior(planes, level, camera, guide, range, &prior);
  return prior;
}

}  // namespace hpm
