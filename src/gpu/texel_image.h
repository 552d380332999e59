// The four taps of a bilinear look-up in one 32-bit word, made on the card from
// the 8-bit image.
#pragma once

#include "src/core/host_device.h"

#include <stddef.h>
#include <stdint.h>

namespace hpm {

// Byte 0: (col, row), 1: (col + 1, row), 2: (col, row + 1), 3: (col + 1, row +
// 1), clamped at the right and lower border.
HPM_HD uint32_t
TexelAt(const uint8_t* grey, int width, int height, int col, int row) {
  const int right = col + 1 < width ? col + 1 : col;
  const int below = row + 1 < height ? row + 1 : row;
  const uint8_t* top = grey + static_cast<size_t>(row) * width;
  const uint8_t* bottom = grey + static_cast<size_t>(below) * width;
  return top[col] | static_cast<uint32_t>(top[right]) << 8 |
         static_cast<uint32_t>(bottom[col]) << 16 |
         static_cast<uint32_t>(bottom[right]) << 24;
}

}  // namespace hpm
