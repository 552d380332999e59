#include "src/image/shrink_image.h"

#include <algorithm>

namespace hpm {

GrayImage ShrinkImage(const GrayImage& image, int level) {
  const int factor = 1 << level;
  GrayImage result;
  result.width = (image.width + factor - 1) / factor;
  result.height = (image.height + factor - 1) / factor;
  result.has_gaps = image.has_gaps;
  result.data.reserve(static_cast<size_t>(result.width) * result.height);
  for (int row = 0; row < result.height; ++row) {
    for (int col = 0; col < result.width; ++col) {
      const int right = std::min((col + 1) * factor, image.width);
      const int bottom = std::min((row + 1) * factor, image.height);
      int sum = 0, num_gaps = 0;
      for (int r = row * factor; r < bottom; ++r) {
        for (int c = col * factor; c < right; ++c) {
          sum += image.at(c, r);
          num_gaps += image.at(c, r) == 0;
        }
      }
      int count = (right - col * factor) * (bottom - row * factor);
      if (image.has_gaps) {
        if (2 * num_gaps > count) sum = 0;  // most of it shows nothing
        count -= 2 * num_gaps > count ? 0 : num_gaps;
      }
      result.data.push_back(static_cast<uint8_t>((sum + count / 2) / count));
    }
  }
  return result;
}

}  // namespace hpm
