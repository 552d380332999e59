#include "src/image/inverse_depth_map.h"

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

namespace hpm {

namespace {

constexpr size_t kGrain = 1 << 15;  // pixels; less is not worth a task

// The largest value, but not so large that a single wrong pixel next to the
// camera would leave the others few steps.
float TopOf(const float* values, size_t count) {
  constexpr float kMostOverMedian = 64;
  constexpr size_t kNumSamples = 10000;
  const size_t stride = count / kNumSamples + 1;
  std::vector<float> samples;
  for (size_t i = 0; i < count; i += stride) {
    if (values[i] > 0) samples.push_back(values[i]);
  }
  const float largest = tbb::parallel_reduce(
      tbb::blocked_range<size_t>(0, count, kGrain),
      0.0f,
      [&](const auto& range, float top) {
        for (size_t i = range.begin(); i < range.end(); ++i)
          top = values[i] > top ? values[i] : top;
        return top;
      },
      [](float a, float b) { return std::max(a, b); });
  if (samples.empty()) return largest;
  const auto middle =
      samples.begin() + static_cast<ptrdiff_t>(samples.size() / 2);
  std::nth_element(samples.begin(), middle, samples.end());
  return std::min(largest, kMostOverMedian * *middle);
}

}  // namespace

InverseDepthMap InverseDepthMap::Of(const float* values, size_t count) {
  constexpr double kNumSteps = (1 << 24) - 1;
  InverseDepthMap map;
  map.steps.resize(kInverseDepthBytes * count + 1);
  const float top = TopOf(values, count);
  if (!(top > 0)) return map;
  map.step = static_cast<float>(top / kNumSteps);
  const double step = map.step;
  tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kGrain),
                    [&](const auto& range) {
                      for (size_t i = range.begin(); i < range.end(); ++i) {
                        if (!(values[i] > 0)) continue;
                        // Not below one step, which would read as "no depth".
                        // To the nearest step, which is what cutting off after
                        // adding a half gives from one on.
                        const double half_above =
                            std::clamp(values[i] / step, 1.0, kNumSteps) + 0.5;
                        const auto whole = static_cast<uint32_t>(half_above);
                        uint8_t* bytes = &map.steps[kInverseDepthBytes * i];
                        bytes[0] = static_cast<uint8_t>(whole);
                        bytes[1] = static_cast<uint8_t>(whole >> 8);
                        bytes[2] = static_cast<uint8_t>(whole >> 16);
                      }
                    });
  return map;
}

}  // namespace hpm
