// The matching cost of src/core/match_cost.h for one (plane, view) pair, as the
// card computes it: the same sums over the same samples, with one reciprocal
// per sample and the window read from where all lanes of a warp can see it.
#pragma once

#include "src/gpu/samplers.h"

// Rows of a window whose samples are fetched at once; the benchmark compares
// other numbers (docs/gpu.md).
#if !defined(HPM_ROWS)
#define HPM_ROWS 3
#endif

namespace hpm {

constexpr int kRowsAtOnce = HPM_ROWS;

struct WindowSample {
  float weight, weighted;  // of RefPatch
};

// The window of one pixel among those of a group of pixels: sample k stands at
// [k * stride], so that lanes with different pixels hit different banks.
struct Window {
  const WindowSample* samples;
  int stride;
  float center, mean, variance;
};

HPM_HD void StoreWindow(const RefPatch& patch,
                        WindowSample* samples,
                        int stride) {
  for (int k = 0; k < kPatchSize; ++k) {
    samples[k * stride] = {patch.weight[k], patch.weighted[k]};
  }
}

template <class Sampler>
HPM_HD float PairCost(const PatchShape& shape,
                      const Window& window,
                      const ViewGeometry& view,
                      int layer,
                      const PlaneSlope& slope,
                      float col,
                      float row,
                      const Sampler& sampler) {
  if (window.variance < kMinVariance) return kMaxCost;
  const float* M = view.M;
  const float neg_inv_z = slope.col * col + slope.row * row + slope.constant;
  const PatchWarp warp = {
      {M[0] * col + M[1] * row + M[2] - neg_inv_z * view.v[0],
       M[3] * col + M[4] * row + M[5] - neg_inv_z * view.v[1],
       M[6] * col + M[7] * row + M[8] - neg_inv_z * view.v[2]},
      {M[0] - slope.col * view.v[0],
       M[3] - slope.col * view.v[1],
       M[6] - slope.col * view.v[2]},
      {M[1] - slope.row * view.v[0],
       M[4] - slope.row * view.v[1],
       M[7] - slope.row * view.v[2]}};
  if (!IsVisible(warp, shape, view.width, view.height)) return kMaxCost;
  if (view.has_gaps != 0 && IsInGap(warp, [&](float u, float v) {
        return sampler(view, layer, u, v);
      })) {
    return kMaxCost;
  }
  float sum_s = 0, sum_ss = 0, sum_rs = 0;
#if defined(HPM_DEVICE_PASS)
#pragma unroll kRowsAtOnce
#endif
  for (int j = 0; j < kPatchAxis; ++j) {
    const Vec3f line =
        warp.origin + static_cast<float>(shape.offset[j]) * warp.drow;
#if defined(HPM_DEVICE_PASS)
#pragma unroll
#endif
    for (int i = 0; i < kPatchAxis; ++i) {
      const Vec3f q = line + static_cast<float>(shape.offset[i]) * warp.dcol;
      const float inv_z = FastReciprocal(q.z);
      const float s =
          sampler(view, layer, q.x * inv_z, q.y * inv_z) - window.center;
      const WindowSample w =
          window.samples[(j * kPatchAxis + i) * window.stride];
      sum_s += w.weight * s;
      sum_ss += w.weight * s * s;
      sum_rs += w.weighted * s;
    }
  }
  const float variance = sum_ss - sum_s * sum_s;
  if (variance < kMinVariance) return kMaxCost;
  const float covariance = sum_rs - window.mean * sum_s;
  return Clamp(1.0f - covariance * FastInverseSqrt(window.variance * variance),
               0.0f,
               kMaxCost);
}

}  // namespace hpm
