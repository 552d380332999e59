// Source images as the CPU's matching cost reads them: a texel holds a pixel
// and the one below, so that 32 bits from a texel on are the 2x2 neighbourhood
// and one gather fetches all four taps of a bilinear look-up.
#pragma once

#include "src/image/gray_image.h"

#include <cstdint>
#include <vector>

namespace hpm {

using Texel = uint16_t;

// Texels behind the last image that a look-up may touch.
constexpr size_t kTexelPadding = 1;

// Low byte: (col, row), high byte: (col, row + 1), clamped at the lower border.
// `texels` has width * height entries. At the right border the right half of a
// look-up is the next row's; it has no weight there.
void PackTexels(const GrayImage& image, Texel* texels);

}  // namespace hpm
