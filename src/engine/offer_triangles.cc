#include "src/engine/offer_triangles.h"

#include "src/base/large_vectors.h"
#include "src/core/prior_term.h"
#include "src/prior/planar_prior.h"

#include <algorithm>

namespace hpm {
namespace {

// So that what is asked at a time stays small in large images.
constexpr int kRowsAtATime = 64;

// Share of a region on which views agree.
constexpr float kHalfFound = 0.5f;

bool IsWithout(const WeakRegions& regions,
               const std::vector<float>& agreement,
               const HypothesisMap& map,
               size_t at) {
  const int label = regions.label[at];
  return label > 0 && agreement[label] < kHalfFound &&
         !(map.priors[at].distance > 0);
}

// The depths of the map and what they cost in the views; of every second pixel,
// which leaves a dozen in each cell that one credible point is sought in.
LevelMap Judged(const ViewSet& views,
                const HypothesisMap& map,
                const ScorePlanes& score) {
  const Camera& camera = views.ref.camera;
  LevelMap judged = {camera,
                     Filled(map.planes.size(), 0.0f),
                     Filled(map.planes.size(), kMaxCost)};
  for (int begin = 0; begin < map.height; begin += kRowsAtATime) {
    const int end = std::min(map.height, begin + kRowsAtATime);
    std::vector<PixelPlane> asked;
    for (int row = begin; row < end; ++row) {
      for (int col = row % 2; col < map.width; col += 2) {
        const size_t at = static_cast<size_t>(row) * map.width + col;
        const Plane& plane = map.planes[at];
        if (!(plane.distance > 0)) continue;
        judged.depths[at] = DepthAt(
            camera, plane, static_cast<float>(col), static_cast<float>(row));
        asked.push_back({col, row, plane});
      }
    }
    const std::vector<float> costs = score(asked);
    for (size_t i = 0; i < asked.size(); ++i) {
      const size_t row = static_cast<size_t>(asked[i].row);
      judged.costs[row * map.width + asked[i].col] = costs[i];
    }
  }
  return judged;
}

}  // namespace

void OfferTriangles(const ViewSet& views,
                    const WeakRegions& regions,
                    const std::vector<float>& agreement,
                    const ScorePlanes& score,
                    HypothesisMap* map) {
  size_t first = 0;
  while (first < map->priors.size() &&
         !IsWithout(regions, agreement, *map, first))
    ++first;
  if (first == map->priors.size()) return;
  const std::vector<Plane> triangles = MakePlanarPrior(
      views.ref.camera,
      FindCrediblePoints(Judged(views, *map, score), kCredibleCost),
      {views.depth_min, views.depth_max},
      OutsideTriangles::kNothing);
  for (size_t at = first; at < triangles.size(); ++at) {
    if (!(triangles[at].distance > 0) ||
        !IsWithout(regions, agreement, *map, at))
      continue;
    map->priors[at] = triangles[at];
    map->planes[at] = triangles[at];
  }
  map->Touch();
}

}  // namespace hpm
