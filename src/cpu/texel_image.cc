#include "src/cpu/texel_image.h"

namespace hpm {

void PackTexels(const GrayImage& image, Texel* texels) {
  for (int row = 0; row < image.height; ++row) {
    const uint8_t* top = &image.data[static_cast<size_t>(row) * image.width];
    const uint8_t* bottom = row + 1 < image.height ? top + image.width : top;
    for (int col = 0; col < image.width; ++col) {
      *texels++ = static_cast<Texel>(top[col] | bottom[col] << 8);
    }
  }
}

}  // namespace hpm
