// Surfaces are smooth where nothing says otherwise: every pixel takes the plane
// that its neighbourhood of one surface lies on.
#pragma once

#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/planar_prior.h"

namespace hpm {

// Replaces the plane of every pixel by a robust fit to the inverse depths of
// the 7x7 pixels around it, weighted by nearness, likeness of grey value and
// distance to the pixel's own plane; `tolerance` (1/z) is the distance at which
// a neighbour counts a quarter. Matching finds depths well and normals badly:
// their window tells little about a tilt. COLMAP's fusion joins only pixels
// whose normals agree. A fit outside `range` is not taken. Costs and masks
// stay. `image` is the reference's, of the map's size.
void FitLocalPlanes(const Camera& camera,
                    const GrayImage& image,
                    float tolerance,
                    const PriorRange& range,
                    HypothesisMap* map);

}  // namespace hpm
