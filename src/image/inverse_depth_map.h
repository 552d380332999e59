// The depth map of a source view as geometric passes read it.
#pragma once

#include "src/core/geometric_term.h"
#include "src/image/hypothesis_map.h"

#include <cstdint>
#include <vector>

namespace hpm {

// 1/z at pixel centres, row-major, in 2^24 - 1 steps up to the largest. As
// exact as floats in a quarter less memory; 16 bits were seen to tilt walls.
struct InverseDepthMap {
  float step = 0;              // 1 / model unit
  std::vector<uint8_t> steps;  // see InverseDepths

  // values: 1/z, 0 = none.
  static InverseDepthMap Of(const std::vector<float>& values);
  static InverseDepthMap Of(const HypothesisMap& map, const Camera& camera);

  InverseDepths View() const { return {steps.data(), step}; }
};

}  // namespace hpm
