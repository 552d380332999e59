#include "src/image/shrink_image.h"

#include <algorithm>

namespace hpm {

GrayImage ShrinkImage(const GrayImage& image, int level) {
  const int factor = 1 << level;
  GrayImage result;
  result.width = (image.width + factor - 1) / factor;
  result.height = (image.height + factor - 1) / factor;
  result.data.reserve(static_cast<size_t>(result.width) * result.height);
  for (int row = 0; row < result.height; ++row) {
    for (int col = 0; col < result.width; ++col) {
      const int right = std::min((col + 1) * factor, image.width);
      const int bottom = std::min((row + 1) * factor, image.height);
      int sum = 0;
      for (int r = row * factor; r < bottom; ++r) {
        for (int c = col * factor; c < right; ++c) sum += image.at(c, r);
      }
      const int count = (right - col * factor) * (bottom - row * factor);
      result.data.push_back(static_cast<uint8_t>((sum + count / 2) / count));
    }
  }
  return result;
}

}  // namespace hpm
