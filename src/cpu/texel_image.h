// Source images as the CPU's matching cost reads them: one 32-bit texel per
// pixel holds the 2x2 neighbourhood, so that one gather fetches all four taps
// of a bilinear look-up.
#pragma once

#include "src/image/gray_image.h"

#include <cstdint>
#include <vector>

namespace hpm {

// Byte 0: (col, row), 1: (col + 1, row), 2: (col, row + 1), 3: (col + 1, row +
// 1), clamped at the right and lower border. `texels` has width * height
// entries.
void PackTexels(const GrayImage& image, uint32_t* texels);

}  // namespace hpm
