// Point clouds as binary little-endian PLY, the form that COLMAP's fusion
// writes.
#pragma once

#include "src/core/vec.h"

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

namespace hpm {

// World frame, model units. `normals` and `colors` are empty or as long as
// `points`.
struct PointCloud {
  std::vector<Vec3f> points;
  std::vector<Vec3f> normals;
  std::vector<std::array<uint8_t, 3>> colors;  // red, green, blue
};

// Reads the vertices; they must be the first element and have scalar properties
// (faces and further properties are passed over). Points that are not finite
// are kept. Throws Error(kBadInput) naming the file.
PointCloud ReadPly(const std::filesystem::path& path);

void WritePly(const std::filesystem::path& path, const PointCloud& cloud);

}  // namespace hpm
