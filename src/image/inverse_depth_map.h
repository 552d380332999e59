// The depth map of a source view as geometric passes read it.
#pragma once

#include "src/core/geometric_term.h"

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hpm {

// 1/z at pixel centres, row-major, in 2^24 - 1 steps up to the largest or 64
// times the median; what is nearer counts as just as near. A quarter less
// memory than floats; 16 bits were seen to tilt walls.
struct InverseDepthMap {
  float step = 0;              // 1 / model unit
  std::vector<uint8_t> steps;  // see InverseDepths

  // values: 1/z, 0 = none.
  static InverseDepthMap Of(const float* values, size_t count);
  static InverseDepthMap Of(const std::vector<float>& values) {
    return Of(values.data(), values.size());
  }

  InverseDepths View() const { return {steps.data(), step}; }
};

}  // namespace hpm
