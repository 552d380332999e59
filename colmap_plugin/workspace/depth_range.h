// Depth range of each image: given by the user for all, or COLMAP's automatic
// one from the sparse points it sees. Depth is z in the camera frame, model
// units.
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <optional>
#include <vector>

namespace hpm {

struct DepthRange {
  float min = 0;
  float max = 0;
};

class DepthRanges {
 public:
  // Automatic if given_min or given_max is negative: [0.75 P1, 1.25 P99] of the
  // positive depths of the points whose track holds the image, one pass over
  // all points. Throws Error(kUsage) for NaN, min > max or a zero max.
  DepthRanges(const Workspace& workspace, double given_min, double given_max);

  // Always 0 < min < max: a lower end of zero becomes 0.001 * max, and equal
  // ends are moved apart by the factors 0.75 and 1.25. Throws Error(kBadInput)
  // naming the image if it has no point in front of it.
  DepthRange ForImage(int image) const;

 private:
  const Workspace& workspace_;
  std::optional<DepthRange> given_;
  std::vector<std::optional<DepthRange>> automatic_;
};

}  // namespace hpm
