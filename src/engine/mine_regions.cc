#include "src/engine/mine_regions.h"

#include "src/engine/visit_params.h"
#include "src/prior/region_planes.h"

#include <algorithm>
#include <cmath>

namespace hpm {
namespace {

// So that an image has about as many points as planes need, at any size.
int LatticeStep(const HypothesisMap& map) {
  constexpr double kNumPoints = 30000;
  return std::max(1,
                  static_cast<int>(std::sqrt(map.planes.size() / kNumPoints)));
}

// Pixels of a lattice that at least `needed` views agree on.
std::vector<ReliablePoint> ReliablePoints(Backend* backend,
                                          const Camera& camera,
                                          float max_error,
                                          int needed,
                                          const HypothesisMap& map,
                                          const RunControl& control) {
  const FilterParams filter = {-1, 0, max_error, 0, LatticeStep(map)};
  const std::vector<uint32_t> consistent =
      backend->ConsistentViews(map, filter, true, control);
  std::vector<ReliablePoint> points;
  for (int row = 0; row < map.height; row += filter.step) {
    for (int col = 0; col < map.width; col += filter.step) {
      const size_t at = static_cast<size_t>(row) * map.width + col;
      if (__builtin_popcount(consistent[at]) < needed) continue;
      points.push_back({col,
                        row,
                        1 / DepthAt(camera,
                                    map.planes[at],
                                    static_cast<float>(col),
                                    static_cast<float>(row))});
    }
  }
  return points;
}

}  // namespace

std::vector<Plane> MineRegions(Backend* backend,
                               const ViewSet& views,
                               const MethodParams& params,
                               const HypothesisMap& map,
                               uint64_t key,
                               const RunControl& control) {
  const auto num_depths =
      std::count_if(views.srcs.begin(), views.srcs.end(), [](const View& src) {
        return src.inverse_depth != nullptr;
      });
  if (num_depths == 0 || !(params.region_max_gradient > 0)) return {};
  const WeakRegions regions = FindWeakRegions(
      *views.ref.image, params.region_max_gradient, params.region_min_share);
  if (regions.num_regions == 0) return {};
  const int needed =
      std::min(params.region_min_consistent, static_cast<int>(num_depths));
  return MakeRegionPlanes(regions,
                          views.ref.camera,
                          ReliablePoints(backend,
                                         views.ref.camera,
                                         params.region_max_error,
                                         needed,
                                         map,
                                         control),
                          params.region_max_residual / Parallax(views),
                          {views.depth_min, views.depth_max},
                          CombineBits(views.random_key, key));
}

}  // namespace hpm
