// The matching cost of src/core/match_cost.h for many (plane, view) pairs at
// once, one pair per SIMD lane.
#pragma once

#include "src/core/match_cost.h"

#include <cstdint>

namespace hpm {

// The source views of one problem, as structure of arrays over views.
struct MatchViews {
  Camera ref;
  PatchShape shape;
  int num_views = 0;
  // All images, see texel_image.h; signed 32-bit byte offsets from here reach
  // 2^31 texels.
  const uint8_t* origin = nullptr;
  // Per view; M and v of ViewWarp.
  alignas(64) float M[9][kMaxViews];
  alignas(64) float v[3][kMaxViews];
  alignas(64) float max_u[kMaxViews];     // width - 1
  alignas(64) float max_v[kMaxViews];     // height - 1
  alignas(64) int32_t stride[kMaxViews];  // bytes from row to row
  alignas(64) int32_t offset[kMaxViews];  // bytes from `origin` to the image
  int32_t has_gaps[kMaxViews];            // 0 or 1, see src/image/gaps.h
  bool any_has_gaps = false;
};

// All planes in all views, at one pixel.
struct MatchRequest {
  int col, row;
  const Plane* planes;
  int num_planes;
  const uint8_t* views;
  int num_views;

  int num_pairs() const { return num_planes * num_views; }
};

// Computes costs[i * num_views + k] of planes[i] in view views[k]; `patch` is
// that of the pixel.
using MatchCostFunction = void (*)(const MatchViews& match,
                                   const RefPatch& patch,
                                   const MatchRequest& request,
                                   float* costs);

}  // namespace hpm
