// Planes that may explain a whole region without texture. A triangle of
// neighbouring points cannot reach over a wall; a plane fitted to what is
// reliable in the region or at its rim can. These are candidates: who takes one
// must look for evidence (src/engine/mine_regions.h).
#pragma once

#include "src/core/plane.h"
#include "src/prior/weak_regions.h"

#include <cstdint>
#include <vector>

namespace hpm {

// A pixel whose depth several views agree on.
struct ReliablePoint {
  int col, row;
  float inverse_depth;  // 1/z
};

// The rim of a region: textured pixels at most this far outside, pixels.
constexpr int kRimWidth = 3;

struct RegionPlane {
  Plane plane;    // reference camera frame
  bool from_rim;  // fitted to the rim, else to the inside
  // Points on the plane as a share of the lattice pixels inside, 0..1.
  double inside;
  // Shares of the rim's points: on the plane, and behind it. The edge of an
  // occluder has the occluder's depth, so a rim may lie in front of its
  // region's surface, but nothing can be seen behind it.
  double rim_on, rim_behind;
  // Standard deviation of its points along their narrower direction, over the
  // square root of the region's area: points in line determine no plane.
  double spread;
  // Per cell of RegionPlanes: how densely it is supported around there.
  std::vector<float> nearness;
};

struct RegionPlanes {
  int cell = 1;  // pixels
  int cell_cols = 0;
  std::vector<std::vector<RegionPlane>> of_region;  // by label, 0 is empty

  size_t CellAt(int col, int row) const {
    return static_cast<size_t>(row / cell) * cell_cols + col / cell;
  }
};

// Of every region up to four planes of its inside and four of its rim, found
// one after the other by RANSAC. A point lies on a plane if their 1/z differ by
// less than `tolerance`. `inner` are points of a lattice of `lattice_step`
// pixels inside regions, `rim` all reliable points of the rims.
RegionPlanes FindRegionPlanes(const WeakRegions& regions,
                              const Camera& camera,
                              const std::vector<ReliablePoint>& inner,
                              const std::vector<ReliablePoint>& rim,
                              int lattice_step,
                              float tolerance,
                              uint64_t random_key);

}  // namespace hpm
