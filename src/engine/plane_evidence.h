// What the images themselves say about planes: whether they match better on a
// plane than a little in front of it and behind. Agreement of depth maps says
// nothing where all views follow the same prior or the same noise.
#pragma once

#include "src/core/initialize_pixel.h"
#include "src/engine/view.h"
#include "src/prior/region_planes.h"

#include <functional>
#include <vector>

namespace hpm {

// The costs of planes at pixels, from all views.
using ScorePlanes =
    std::function<std::vector<float>(const std::vector<PixelPlane>& planes)>;

struct PlaneEvidence {
  int num_pixels = 0;  // looked at
  // Mean cost of the plane moved by two pixels in the median view, toward the
  // camera or away, whichever is less, minus its own.
  double distinctness = 0;
};

// As `candidates.of_region`. Looks at every `lattice_step`-th pixel of a region
// whose window of `patch_radius` the region fills (at every one if there are
// too few), each under the nearest
// candidate of its inside and of its rim.
std::vector<std::vector<PlaneEvidence>> FindEvidence(
    const ViewSet& views,
    const WeakRegions& regions,
    const RegionPlanes& candidates,
    int lattice_step,
    int patch_radius,
    const ScorePlanes& score);

}  // namespace hpm
