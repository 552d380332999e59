// Between the library's maps and COLMAP's files. Inside, the value of pixel
// (col, row) belongs to the ray through the pixel's centre. COLMAP's dense code
// and fusion put the value of (col, row) on the ray K^-1 (col, row, 1) of a K
// whose pixel centres lie at +0.5, that is half a pixel up and left of the
// centre. So every plane is evaluated on the other ray on writing and on
// reading; both directions belong together (docs/architecture.md).
#pragma once

#include "colmap_plugin/controller/cost_histogram.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/depth_range.h"
#include "src/image/hypothesis_map.h"
#include "src/image/inverse_depth_map.h"

#include <filesystem>
#include <vector>

namespace hpm {

struct DepthAndNormal {
  Map depth;
  Map normal;
};

struct WrittenDepths {
  size_t num_valid = 0;
  size_t num_dropped = 0;  // outside the range
  CostHistogram costs;     // of the valid ones
};

// Writes all rows; the caller commits. Pixels whose plane does not meet
// COLMAP's ray in front of the camera, whose depth is outside `range` or that
// have keep[i] == false (if given) become 0.
WrittenDepths WritePlanes(const HypothesisMap& map,
                          const Camera& camera,
                          const DepthRange& range,
                          const std::vector<bool>* keep,
                          MapWriter* depth,
                          MapWriter* normal);

// Depths outside `range` become 0, their normals, too. Returns how many.
size_t DropOutside(const DepthRange& range, DepthAndNormal* maps);

// Planes through the stored points; distance 0 where there is no depth. Throws
// Error(kBadInput) naming the file that is damaged or not of the camera's size.
void ReadPlanes(const std::filesystem::path& depth_path,
                const std::filesystem::path& normal_path,
                const Camera& camera,
                std::vector<Plane>* planes);

// The same files, but only 1/z at the centres of the pixels of the camera
// halved `more_levels` times; takes less memory. A coarse pixel has the plane
// of one pixel in its middle.
InverseDepthMap ReadInverseDepths(const std::filesystem::path& depth_path,
                                  const std::filesystem::path& normal_path,
                                  const Camera& camera,
                                  int more_levels = 0);

}  // namespace hpm
