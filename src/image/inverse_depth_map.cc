#include "src/image/inverse_depth_map.h"

#include <algorithm>
#include <cmath>

namespace hpm {

InverseDepthMap InverseDepthMap::Of(const std::vector<float>& values) {
  constexpr double kNumSteps = (1 << 24) - 1;
  InverseDepthMap map;
  map.steps.resize(kInverseDepthBytes * values.size() + 1);
  float largest = 0;
  for (const float value : values) largest = std::max(largest, value);
  if (!(largest > 0)) return map;
  map.step = static_cast<float>(largest / kNumSteps);
  for (size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > 0)) continue;
    // Not below one step, which would read as "no depth".
    const auto steps = static_cast<uint32_t>(std::clamp(
        std::round(values[i] / static_cast<double>(map.step)), 1.0, kNumSteps));
    uint8_t* bytes = &map.steps[kInverseDepthBytes * i];
    bytes[0] = static_cast<uint8_t>(steps);
    bytes[1] = static_cast<uint8_t>(steps >> 8);
    bytes[2] = static_cast<uint8_t>(steps >> 16);
  }
  return map;
}

InverseDepthMap InverseDepthMap::Of(const HypothesisMap& map,
                                    const Camera& camera) {
  std::vector<float> values(map.planes.size(), 0.0f);
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const size_t i = static_cast<size_t>(row) * map.width + col;
      if (!(map.planes[i].distance > 0)) continue;
      values[i] = 1.0f / DepthAt(camera,
                                 map.planes[i],
                                 static_cast<float>(col),
                                 static_cast<float>(row));
    }
  }
  return Of(values);
}

}  // namespace hpm
