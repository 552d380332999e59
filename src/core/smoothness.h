// Smoothness of second order: what a plane costs for leaving the surface that
// the pixels around continue. It weighs in where matching says little, and it
// settles the normal, which the geometric term cannot see.
#pragma once

#include "src/core/pixel_state.h"
#include "src/core/visit.h"

#include <math.h>

namespace hpm {

// The surface around a visited pixel, as its neighbours of the other colour
// hold it.
struct Surroundings {
  static constexpr int kNumTaps = 12;
  int num_taps;
  float col[kNumTaps], row[kNumTaps];
  float neg_inverse_depth[kNumTaps];  // -1/z of the tap's plane at the tap
  float weight[kNumTaps];             // similarity of grey values, 0..1
};

template <class Cost>
HPM_HD void CollectSurroundings(const VisitParams& params,
                                const PixelState& state,
                                const Cost& cost,
                                int col,
                                int row,
                                Surroundings* around) {
  around->num_taps = 0;
  if (!(params.smoothness.weight > 0)) return;
  // At radius 1 and 5, where the patch ends.
  const int dcol[Surroundings::kNumTaps] = {
      0, 0, -1, 1, 0, 0, -5, 5, -3, 3, -4, 4};
  const int drow[Surroundings::kNumTaps] = {
      -1, 1, 0, 0, -5, 5, 0, 0, -4, 4, 3, -3};
  const float here = cost.Grey(col, row);
  for (int k = 0; k < Surroundings::kNumTaps; ++k) {
    const int c = col + dcol[k];
    const int r = row + drow[k];
    if (c < 0 || r < 0 || c >= state.width || r >= state.height) continue;
    const int i = around->num_taps++;
    around->col[i] = static_cast<float>(c);
    around->row[i] = static_cast<float>(r);
    const PlaneSlope slope =
        SlopeOf(params.ref, state.planes[r * state.width + c]);
    around->neg_inverse_depth[i] = slope.col * around->col[i] +
                                   slope.row * around->row[i] + slope.constant;
    const float d = (cost.Grey(c, r) - here) / params.smoothness.sigma_color;
    around->weight[i] = expf(-0.5f * d * d);
  }
}

// In [0, smoothness.weight].
HPM_HD float SmoothnessCost(const VisitParams& params,
                            const Surroundings& around,
                            const Plane& plane) {
  if (around.num_taps == 0) return 0;
  const PlaneSlope slope = SlopeOf(params.ref, plane);
  const float scale = params.parallax / params.smoothness.max_error;
  float sum = 0;
  for (int k = 0; k < around.num_taps; ++k) {
    const float error =
        scale * fabsf(slope.col * around.col[k] + slope.row * around.row[k] +
                      slope.constant - around.neg_inverse_depth[k]);
    sum += around.weight[k] * fminf(error, 1.0f);
  }
  return params.smoothness.weight * sum / Surroundings::kNumTaps;
}

}  // namespace hpm
