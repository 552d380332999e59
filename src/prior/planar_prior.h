// Planar prior of a level: a plane for every pixel, spanned by credible points
// (paper, section 3.3).
#pragma once

#include "src/prior/credible_points.h"

#include <vector>

namespace hpm {

struct PriorRange {
  float depth_min, depth_max;  // model units
};

// What pixels outside the Delaunay triangulation get.
enum class OutsideTriangles {
  kNearestPoints,  // the plane of their nearest credible points: first
                   // non-collinear triple of the K = 6 nearest
  kNothing,
};

// One plane per level pixel, reference camera frame, distance 0 = none.
// Pixels inside the Delaunay triangulation get the plane of their triangle.
// Planes that leave `range` at the pixel are dropped.
std::vector<Plane> MakePlanarPrior(const Camera& level_camera,
                                   const std::vector<CrediblePoint>& points,
                                   const PriorRange& range,
                                   OutsideTriangles outside);

}  // namespace hpm
