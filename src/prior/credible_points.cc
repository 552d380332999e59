#include "src/prior/credible_points.h"

#include <algorithm>

namespace hpm {
namespace {

constexpr int kCell = 5;  // level pixels

}  // namespace

std::vector<CrediblePoint> FindCrediblePoints(const LevelMap& level,
                                              float max_cost) {
  const Camera& camera = level.camera;
  std::vector<CrediblePoint> points;
  for (int top = 0; top < camera.height; top += kCell) {
    for (int left = 0; left < camera.width; left += kCell) {
      int best_col = -1, best_row = -1;
      float best_cost = max_cost;
      for (int row = top; row < std::min(top + kCell, camera.height); ++row) {
        for (int col = left; col < std::min(left + kCell, camera.width);
             ++col) {
          const size_t at = static_cast<size_t>(row) * camera.width + col;
          if (level.depths[at] > 0 && level.costs[at] < best_cost) {
            best_cost = level.costs[at];
            best_col = col;
            best_row = row;
          }
        }
      }
      if (best_col < 0) continue;
      const float z =
          level.depths[static_cast<size_t>(best_row) * camera.width + best_col];
      points.push_back({best_col,
                        best_row,
                        z * RayAt(camera,
                                  static_cast<float>(best_col),
                                  static_cast<float>(best_row))});
    }
  }
  return points;
}

}  // namespace hpm
