#include "src/engine/mine_regions.h"

#include "src/engine/visit_params.h"
#include "src/prior/region_planes.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// So that an image has about as many points as planes need, at any size.
int LatticeStep(const HypothesisMap& map) {
  constexpr double kNumPoints = 30000;
  return std::max(1,
                  static_cast<int>(std::sqrt(map.planes.size() / kNumPoints)));
}

// A source view whose opinion is heard.
struct Witness {
  DepthView view;
  Vec3f center;  // of its camera, in the reference camera frame
};

// The sources that have a depth map.
std::vector<Witness> WitnessesOf(const ViewSet& views) {
  const Camera& ref = views.ref.camera;
  std::vector<Witness> witnesses;
  for (const View& src : views.srcs) {
    if (src.inverse_depth == nullptr) continue;
    witnesses.push_back({{MakeViewWarp(ref, src.camera),
                          MakeViewWarp(src.camera, ref),
                          src.inverse_depth->View()},
                         CamFromWorld(ref, Center(src.camera))});
  }
  return witnesses;
}

// The number of witnesses that bring the pixel of this plane back to within
// max_error pixels; *inverse_depth becomes the mean of what they and the plane
// say, so that the views come to share one surface.
int CountAgreeing(const std::vector<Witness>& witnesses,
                  const Camera& ref,
                  const Plane& plane,
                  float col,
                  float row,
                  float max_error,
                  float* inverse_depth) {
  const PlaneSlope slope = SlopeOf(ref, plane);
  const auto of_plane = [&](float c, float r) {
    return -(slope.col * c + slope.row * r + slope.constant);
  };
  const Vec3f point = (1 / of_plane(col, row)) * RayAt(ref, col, row);
  int count = 0;
  float sum = 0;
  for (const Witness& witness : witnesses) {
    if (Dot(witness.center - point, plane.normal) <= 0) continue;  // its back
    const Reprojection back = Reproject(witness.view, slope, col, row);
    // What is not there has the largest error, which does not agree.
    if (!(ReprojectionError(back, col, row, 2 * max_error) <= max_error))
      continue;
    ++count;
    sum += back.inverse_depth - of_plane(back.col, back.row);
  }
  *inverse_depth = of_plane(col, row) + sum / static_cast<float>(count + 1);
  return count;
}

// Pixels of a lattice that at least `needed` views agree on, row by row.
std::vector<ReliablePoint> ReliablePoints(const std::vector<Witness>& witnesses,
                                          const Camera& ref,
                                          float max_error,
                                          int needed,
                                          const HypothesisMap& map) {
  const int step = LatticeStep(map);
  const int num_rows = (map.height + step - 1) / step;
  std::vector<std::vector<ReliablePoint>> of_row(num_rows);
  tbb::parallel_for(
      tbb::blocked_range<int>(0, num_rows), [&](const auto& rows) {
        for (int i = rows.begin(); i < rows.end(); ++i) {
          const int row = i * step;
          for (int col = 0; col < map.width; col += step) {
            const Plane& plane =
                map.planes[static_cast<size_t>(row) * map.width + col];
            if (!(plane.distance > 0)) continue;
            float inverse_depth;
            const int count = CountAgreeing(witnesses,
                                            ref,
                                            plane,
                                            static_cast<float>(col),
                                            static_cast<float>(row),
                                            max_error,
                                            &inverse_depth);
            if (count >= needed) of_row[i].push_back({col, row, inverse_depth});
          }
        }
      });
  std::vector<ReliablePoint> points;
  for (const auto& row : of_row)
    points.insert(points.end(), row.begin(), row.end());
  return points;
}

}  // namespace

std::vector<Plane> MineRegions(const ViewSet& views,
                               const MethodParams& params,
                               const HypothesisMap& map,
                               uint64_t key) {
  const std::vector<Witness> witnesses = WitnessesOf(views);
  if (witnesses.empty() || !(params.region_max_gradient > 0)) return {};
  const WeakRegions regions = FindWeakRegions(
      *views.ref.image, params.region_max_gradient, params.region_min_share);
  if (regions.num_regions == 0) return {};
  const int needed = std::min(params.region_min_consistent,
                              static_cast<int>(witnesses.size()));
  return MakeRegionPlanes(
      regions,
      views.ref.camera,
      ReliablePoints(
          witnesses, views.ref.camera, params.region_max_error, needed, map),
      params.region_max_residual / Parallax(views),
      {views.depth_min, views.depth_max},
      CombineBits(views.random_key, key));
}

}  // namespace hpm
