#include "src/image/inverse_depth_map.h"

#include <algorithm>
#include <cmath>

namespace hpm {

namespace {

// The largest value, but not so large that a single wrong pixel next to the
// camera would leave the others few steps.
float TopOf(const std::vector<float>& values) {
  constexpr float kMostOverMedian = 64;
  constexpr size_t kNumSamples = 10000;
  const size_t stride = values.size() / kNumSamples + 1;
  std::vector<float> samples;
  float largest = 0;
  for (size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] > 0)) continue;
    largest = std::max(largest, values[i]);
    if (i % stride == 0) samples.push_back(values[i]);
  }
  if (samples.empty()) return largest;
  const auto middle =
      samples.begin() + static_cast<ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  return std::min(largest, kMostOverMedian * *middle);
}

}  // namespace

InverseDepthMap InverseDepthMap::Of(const std::vector<float>& values) {
  constexpr double kNumSteps = (1 << 24) - 1;
  InverseDepthMap map;
  map.steps.resize(kInverseDepthBytes * values.size() + 1);
  const float top = TopOf(values);
  if (!(top > 0)) return map;
  map.step = static_cast<float>(top / kNumSteps);
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

}  // namespace hpm
