// Which pixel of a map stands for a pixel of the same map halved several times:
// the one in the middle of its block.
#pragma once

#include "src/core/plane.h"

#include <algorithm>
#include <cmath>

namespace hpm {

class MiddlePixel {
 public:
  explicit MiddlePixel(int levels) : factor_(1 << levels) {}

  int BlockOf(int pixel) const { return pixel / factor_; }
  // size: of the fine map, along the same axis.
  int Of(int block, int size) const {
    return std::min(block * factor_ + (factor_ - 1) / 2, size - 1);
  }
  // The centre of the block, in fine pixels.
  float CenterOf(int block) const {
    return (static_cast<float>(block) + 0.5f) * static_cast<float>(factor_) -
           0.5f;
  }

 private:
  int factor_;
};

// 1/z at the centre of a block, of the plane that stands for it; 0 where it has
// no depth.
inline float InverseDepthOfBlock(const Camera& camera,
                                 const Plane& plane,
                                 const MiddlePixel& middle,
                                 int block_col,
                                 int block_row) {
  const float z = DepthAt(
      camera, plane, middle.CenterOf(block_col), middle.CenterOf(block_row));
  return plane.distance > 0 && std::isfinite(z) && z > 0 ? 1 / z : 0;
}

}  // namespace hpm
