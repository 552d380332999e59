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
struct PlanesInViews {
  int col, row;
  const Plane* planes;
  int num_planes;
  const uint8_t* views;
  int num_views;

  int num_pairs() const { return num_planes * num_views; }
};

// Pixels whose requests are answered together: one per lane of the widest
// vector.
constexpr int kMaxGroup = 16;

// RefPatch of the pixels of a group, as structure of arrays over pixels.
struct RefPatches {
  alignas(64) float weight[kPatchSize][kMaxGroup];
  alignas(64) float weighted[kPatchSize][kMaxGroup];
  alignas(64) float center[kMaxGroup];
  alignas(64) float mean[kMaxGroup];
  alignas(64) float variance[kMaxGroup];

  void Set(int pixel, const RefPatch& patch) {
    for (int k = 0; k < kPatchSize; ++k) {
      weight[k][pixel] = patch.weight[k];
      weighted[k][pixel] = patch.weighted[k];
    }
    center[pixel] = patch.center;
    mean[pixel] = patch.mean;
    variance[pixel] = patch.variance;
  }

  RefPatch Get(int pixel) const {
    RefPatch patch;
    for (int k = 0; k < kPatchSize; ++k) {
      patch.weight[k] = weight[k][pixel];
      patch.weighted[k] = weighted[k][pixel];
    }
    patch.center = center[pixel];
    patch.mean = mean[pixel];
    patch.variance = variance[pixel];
    return patch;
  }
};

// costs[i * num_views + k]: of planes[i] in view views[k].
struct MatchRequest {
  PlanesInViews asked;
  int pixel;  // of the group
  float* costs;
};

// Answers all requests, which stand in the order of their pixels. `patches` are
// those of the group.
using MatchCostFunction = void (*)(const MatchViews& match,
                                   const RefPatches& patches,
                                   const MatchRequest* requests,
                                   int num_requests);

}  // namespace hpm
