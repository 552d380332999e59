// Depth range of each image: given by the user for all, or COLMAP's automatic
// one from the sparse points it sees. Depth is z in the camera frame, model
// units.
//
// A given range says what is wanted, not what the images show: a search that
// cannot find the surface outside finds a false one inside. So the search is
// wider than the given range, and what lies outside is dropped in the end.
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <limits>
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

  // What to search. Always 0 < min < max: a lower end of zero becomes 0.001 *
  // max, and equal ends are moved apart by the factors 0.75 and 1.25. A given
  // range grows to hold the automatic one, as far as kSearchedBeyond goes: it
  // is also the remedy for wrong points. Throws Error(kBadInput) naming the
  // image if no range is given and it has no point in front of it.
  DepthRange ForImage(int image) const;

  // What to publish: the given range, else everything.
  DepthRange Published() const {
    return given_.value_or(
        DepthRange{0, std::numeric_limits<float>::infinity()});
  }

  // A factor, at both ends of a given range.
  static constexpr float kSearchedBeyond = 4;

 private:
  const Workspace& workspace_;
  std::optional<DepthRange> given_;
  std::vector<std::optional<DepthRange>> automatic_;
};

}  // namespace hpm
