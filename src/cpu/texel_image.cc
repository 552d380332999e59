#include "src/cpu/texel_image.h"

#include <algorithm>

namespace hpm {

void PackTexels(const GrayImage& image, uint32_t* texels) {
  for (int row = 0; row < image.height; ++row) {
    const uint8_t* top = &image.data[static_cast<size_t>(row) * image.width];
    const uint8_t* bottom = row + 1 < image.height ? top + image.width : top;
    for (int col = 0; col < image.width; ++col) {
      const int right = std::min(col + 1, image.width - 1);
      *texels++ = top[col] | top[right] << 8 | bottom[col] << 16 |
                  static_cast<uint32_t>(bottom[right]) << 24;
    }
  }
}

}  // namespace hpm
