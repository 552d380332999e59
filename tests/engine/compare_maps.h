// What tests ask of two maps: the same bytes, or nearly the same depths.
#pragma once

#include "src/core/camera.h"
#include "src/image/hypothesis_map.h"

#include <cmath>
#include <cstring>
#include <vector>

namespace hpm {

template <class T>
bool SameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  if (a.size() != b.size()) return false;
  // The data of an empty vector may be null, which memcmp does not allow.
  return a.empty() ||
         std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

inline bool SameMaps(const HypothesisMap& a, const HypothesisMap& b) {
  return SameBytes(a.planes, b.planes) && SameBytes(a.costs, b.costs) &&
         SameBytes(a.masks, b.masks);
}

// Share of pixels whose depths differ by more than 1 %.
inline double DifferingShare(const HypothesisMap& a,
                             const HypothesisMap& b,
                             const Camera& camera) {
  int num_differing = 0;
  for (int row = 0; row < a.height; ++row) {
    for (int col = 0; col < a.width; ++col) {
      const size_t at = static_cast<size_t>(row) * a.width + col;
      const float x = static_cast<float>(col), y = static_cast<float>(row);
      const float za = DepthAt(camera, a.planes[at], x, y);
      const float zb = DepthAt(camera, b.planes[at], x, y);
      num_differing += !(std::abs(za - zb) <= 0.01f * zb);
    }
  }
  return num_differing / static_cast<double>(a.planes.size());
}

}  // namespace hpm
