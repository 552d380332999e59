// Visits per pixel (HypothesisMap::visits) in a pattern that leaves whole
// groups of pixels out, and parts of others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace hpm {

inline std::vector<uint8_t> MadeUpVisits(int width, int height) {
  std::vector<uint8_t> visits;
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const int i = row * width + col;
      const bool settled = i % 5 < 2 || row % 4 == 1;
      visits.push_back(settled ? 0 : i % 3 == 0 ? 1 : 255);
    }
  }
  return visits;
}

}  // namespace hpm
