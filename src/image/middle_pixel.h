// Which pixel of a map stands for a pixel of the same map halved several times:
// the one in the middle of its block.
#pragma once

#include <algorithm>

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

}  // namespace hpm
