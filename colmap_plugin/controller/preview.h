// Colour pictures of depth and normal maps, for people.
#pragma once

#include "colmap_plugin/controller/ray_convention.h"

#include <filesystem>
#include <string>

namespace hpm {

// Writes <folder>/<name>.depth.jpg (near = warm, far = cool, by inverse depth
// between the 2nd and 98th percentile, black = none) and <name>.normal.jpg
// (x, y, -z as red, green, blue). Throws Error(kBadInput) if a file cannot be
// written.
void WritePreviews(const std::filesystem::path& folder,
                   const std::string& name,
                   const DepthAndNormal& maps);

// The same pictures as the bytes of JPEG files.
std::string DepthPreview(const Map& depth, int quality);
std::string NormalPreview(const Map& normal, int quality);
// 0 dark blue, 1 yellow, black = no depth.
std::string ConfidencePreview(const Map& confidence, int quality);

}  // namespace hpm
