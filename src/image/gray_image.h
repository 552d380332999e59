// 8-bit grey images, as the matching cost sees them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hpm {

// Row-major, values 0..255, no padding.
struct GrayImage {
  int width = 0;
  int height = 0;
  std::vector<uint8_t> data;
  // Then 0 means that there is nothing to see, and no other pixel has it: see
  // gaps.h.
  bool has_gaps = false;

  uint8_t at(int col, int row) const {
    return data[static_cast<size_t>(row) * width + col];
  }
  bool IsGap(size_t at) const { return has_gaps && data[at] == 0; }
};

}  // namespace hpm
