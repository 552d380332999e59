// Delaunay triangulation of image points.
#pragma once

#include "src/prior/credible_points.h"

#include <array>
#include <vector>

namespace hpm {

// Indices into `points`, in an order that depends on the points alone. Empty
// for fewer than three points or only collinear ones; repeated points count
// once.
std::vector<std::array<int, 3>> Triangulate(
    const std::vector<CrediblePoint>& points, int width, int height);

}  // namespace hpm
