// Maps as files that other programs read: EXR, PFM, NumPy's NPY and PLY. The
// contents of the files; nothing is written here.
#pragma once

#include "colmap_plugin/formats/map_file.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace hpm {

// OpenEXR, one part, scan lines, uncompressed 32-bit floats. One channel is
// named Y, three R, G, B.
std::string EncodeExr(const Map& map);

// Portable float map, little-endian; its rows go from the bottom to the top.
std::string EncodePfm(const Map& map);

// NumPy: shape (height, width) or (height, width, 3), '<f4'.
std::string EncodeNpy(const Map& map);

struct CloudPoint {
  std::array<double, 3> position;  // double: models may lie far from the origin
  std::array<float, 3> normal;
  std::array<uint8_t, 3> rgb;
};

// PLY, binary, little-endian.
std::string EncodePly(const std::vector<CloudPoint>& points);

}  // namespace hpm
