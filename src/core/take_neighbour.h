// A pixel that an iteration has not visited follows those that it has.
#pragma once

#include "src/core/pixel_state.h"
#include "src/core/visit.h"

namespace hpm {

// What a cost may rise in a geometric pass, for a plane refined at this size in
// place of one that came up from a coarser level. At first its own cost is
// photometric, those beside it have the geometric term (but for settled ones):
// where the views disagree the pixel keeps its own.
constexpr float kRefinedMayCostMore = 0.1f;

// Whether the plane of another pixel faces this one at an accepted depth.
HPM_HD bool IsAccepted(const VisitParams& params,
                       const Plane& plane,
                       int col,
                       int row) {
  const Vec3f ray =
      RayAt(params.ref, static_cast<float>(col), static_cast<float>(row));
  const float facing = -Dot(plane.normal, ray);
  const float z = plane.distance / facing;
  return facing > 0 && z >= params.depth_min && z <= params.depth_max;
}

// Takes the hypothesis of the direct neighbour, of the other colour, whose cost
// is smallest; keeps its own where it matches better, in a geometric pass
// clearly better.
HPM_HD void TakeNeighbour(const VisitParams& params,
                          const PixelState& state,
                          int col,
                          int row) {
  const int at = row * state.width + col;
  const int dcol[4] = {0, -1, 1, 0};
  const int drow[4] = {-1, 0, 0, 1};
  int best = at;
  float best_cost =
      state.costs[at] + (params.geometric ? kRefinedMayCostMore : 0.0f);
  for (int b = 0; b < 4; ++b) {
    const int c = col + dcol[b];
    const int r = row + drow[b];
    if (c < 0 || r < 0 || c >= state.width || r >= state.height) continue;
    const int neighbour = r * state.width + c;
    if (!(state.costs[neighbour] < best_cost)) continue;
    if (!IsAccepted(params, state.planes[neighbour], col, row)) continue;
    best = neighbour;
    best_cost = state.costs[neighbour];
  }
  if (best == at) return;
  state.planes[at] = state.planes[best];
  state.costs[at] = state.costs[best];
  state.masks[at] = state.masks[best];
}

}  // namespace hpm
