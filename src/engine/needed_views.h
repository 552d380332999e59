// How many sources must confirm a pixel of a finished map, and how many can.
#pragma once

#include "src/core/consistency_filter.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"

#include <cstddef>
#include <vector>

namespace hpm {

// The minimum of COLMAP's filter; where the map is unexplained
// (HypothesisMap::unexplained) a share of the sources that see the plane, half
// unless told otherwise, if that is more. In front of a sky all views
// find what hangs over the roofs, but not the same everywhere, so that fewer
// of them agree than on a wall.
class NeededViews {
 public:
  // Keeps references to `views` and `map`.
  NeededViews(const ViewSet& views,
              const HypothesisMap& map,
              const FilterParams& filter,
              double min_agreement,
              bool geometric);

  // Of pixel row * width + col.
  int At(size_t at) const;

  // Sources into whose image the pixel falls, from whose side its plane is
  // seen, at a sufficient angle and with nothing clearly nearer in between;
  // after geometric passes those with a depth map: no other can confirm it.
  int CountSeeing(size_t at) const;

 private:
  const ViewSet& views_;
  const HypothesisMap& map_;
  const int min_num_consistent_;
  const double min_agreement_;
  const float max_cos_;
  const bool geometric_;
  std::vector<ViewWarp> warps_;
  std::vector<Vec3f> centers_;  // of the sources, reference camera frame
};

}  // namespace hpm
