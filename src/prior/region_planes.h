// Planes that explain a whole region without texture: robustly fitted to what
// is reliable inside it, wherever in the region that lies. A triangle of
// neighbouring points cannot reach that far.
#pragma once

#include "src/prior/planar_prior.h"
#include "src/prior/weak_regions.h"

#include <cstdint>
#include <vector>

namespace hpm {

// A pixel whose depth several views agree on.
struct ReliablePoint {
  int col, row;
  float inverse_depth;  // 1/z
};

// One plane per pixel, reference camera frame, distance 0 = none.
// A point supports a plane if their 1/z differ by less than `tolerance`.
// Regions get up to four planes, found one after the other by RANSAC; a pixel
// takes the plane with the densest support around it.
std::vector<Plane> MakeRegionPlanes(const WeakRegions& regions,
                                    const Camera& camera,
                                    const std::vector<ReliablePoint>& points,
                                    float tolerance,
                                    const PriorRange& range,
                                    uint64_t random_key);

}  // namespace hpm
