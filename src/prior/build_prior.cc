#include "src/prior/build_prior.h"

#include "src/prior/upsample_prior.h"

namespace hpm {

std::vector<Plane> BuildPrior(const HypothesisMap& map,
                              const Camera& camera,
                              const GrayImage& guide,
                              int level,
                              const PriorRange& range) {
  const LevelMap reduced = MakeLevel(map, camera, level);
  const std::vector<CrediblePoint> points =
      FindCrediblePoints(reduced, kCredibleCost);
  std::vector<Plane> planes = MakePlanarPrior(reduced.camera, points, range);
  if (level == 0) return planes;
  return UpsamplePrior(planes, level, camera, guide, range);
}

}  // namespace hpm
