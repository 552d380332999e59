// Between the library's maps and COLMAP's files. Inside, the value of pixel
// (col, row) belongs to the ray through the pixel's centre. COLMAP's dense code
// and fusion put the value of (col, row) on the ray K^-1 (col, row, 1) of a K
// whose pixel centres lie at +0.5, that is half a pixel up and left of the
// centre. So every plane is evaluated on the other ray on writing and on
// reading; both functions belong together (docs/architecture.md).
#pragma once

#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/depth_range.h"
#include "src/image/hypothesis_map.h"

#include <filesystem>
#include <vector>

namespace hpm {

struct DepthAndNormal {
  Map depth;
  Map normal;
};

// Pixels whose plane does not meet COLMAP's ray in front of the camera, and
// pixels with keep[i] == false (if given), become 0.
DepthAndNormal ToColmapMaps(const HypothesisMap& map,
                            const Camera& camera,
                            const std::vector<bool>* keep = nullptr);

// Depths outside `range` become 0, their normals, too. Returns how many.
size_t DropOutside(const DepthRange& range, DepthAndNormal* maps);

// Planes through the stored points; distance 0 where there is no depth. Both
// maps must have the camera's size.
HypothesisMap FromColmapMaps(const Map& depth,
                             const Map& normal,
                             const Camera& camera);

// Reads both files; throws Error(kBadInput) naming the one that is damaged or
// not of the camera's size.
HypothesisMap ReadHypotheses(const std::filesystem::path& depth_path,
                             const std::filesystem::path& normal_path,
                             const Camera& camera);

// The same files, but only 1/z at the centres of the pixels of the camera
// halved `more_levels` times, 0 = none; takes less memory. A coarse pixel has
// the plane of one pixel in its middle.
std::vector<float> ReadInverseDepths(const std::filesystem::path& depth_path,
                                     const std::filesystem::path& normal_path,
                                     const Camera& camera,
                                     int more_levels = 0);

}  // namespace hpm
