#include "colmap_plugin/workspace/seen_points.h"

#include <algorithm>

namespace hpm {
namespace {

// Enough for percentiles, and for thousands of images together few enough.
constexpr size_t kMaxPoints = 100000;
constexpr size_t kMinPoints = 5000;
constexpr size_t kMaxProjections = 50000000;
// Parts of an image in which surfaces hide what is behind: cells of a grid.
constexpr size_t kCellsPerSide = 24;
// A slanted surface may run this far back within a cell. The front is taken
// where a tenth of the cell's points lie before it: those may float.
constexpr double kHiddenBehind = 2;
constexpr size_t kFrontShare = 10;

}  // namespace

SeenPoints::SeenPoints(const Workspace& workspace) : views_(workspace) {
  const SparsePoints& points = workspace.model().points;
  const size_t max_points =
      std::clamp(kMaxProjections / (workspace.model().images.size() + 1),
                 kMinPoints,
                 kMaxPoints);
  const size_t step = points.size() / max_points + 1;
  points_.reserve(points.size() / step + 1);
  for (size_t i = 0; i < points.size(); i += step) {
    points_.push_back(points[i].xyz);
  }
}

std::vector<SeenPoints::SeenPoint> SeenPoints::ForImage(int image) const {
  std::vector<std::vector<SeenPoint>> cells(kCellsPerSide * kCellsPerSide);
  for (const Eigen::Vector3d& xyz : points_) {
    const auto projection = views_.Project(image, xyz);
    if (!projection) continue;
    const auto col = static_cast<size_t>(projection->x * kCellsPerSide);
    const auto row = static_cast<size_t>(projection->y * kCellsPerSide);
    cells[kCellsPerSide * row + col].push_back({xyz, projection->depth});
  }
  std::vector<SeenPoint> seen;
  for (std::vector<SeenPoint>& points : cells) {
    if (points.empty()) continue;
    std::stable_sort(points.begin(),
                     points.end(),
                     [](const SeenPoint& a, const SeenPoint& b) {
                       return a.depth < b.depth;
                     });
    const double front = points[points.size() / kFrontShare].depth;
    for (const SeenPoint& point : points) {
      if (point.depth <= kHiddenBehind * front) seen.push_back(point);
    }
  }
  return seen;
}

}  // namespace hpm
