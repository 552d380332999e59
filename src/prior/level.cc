#include "src/prior/level.h"

#include <algorithm>

namespace hpm {

LevelMap MakeLevel(const HypothesisMap& map, const Camera& camera, int level) {
  LevelMap result;
  result.camera = LevelCamera(camera, level);
  const int factor = 1 << level;
  const size_t size =
      static_cast<size_t>(result.camera.width) * result.camera.height;
  result.depths.assign(size, 0.0f);
  result.costs.assign(size, kMaxCost);
  for (int row = 0; row < result.camera.height; ++row) {
    for (int col = 0; col < result.camera.width; ++col) {
      const size_t at = static_cast<size_t>(row) * result.camera.width + col;
      const Plane* best = nullptr;
      for (int r = row * factor; r < std::min((row + 1) * factor, map.height);
           ++r) {
        for (int c = col * factor; c < std::min((col + 1) * factor, map.width);
             ++c) {
          const size_t i = static_cast<size_t>(r) * map.width + c;
          if (map.costs[i] < result.costs[at] && map.planes[i].distance > 0) {
            result.costs[at] = map.costs[i];
            best = &map.planes[i];
          }
        }
      }
      if (best == nullptr) continue;
      const float z = DepthAt(result.camera,
                              *best,
                              static_cast<float>(col),
                              static_cast<float>(row));
      if (z > 0) result.depths[at] = z;
    }
  }
  return result;
}

}  // namespace hpm
