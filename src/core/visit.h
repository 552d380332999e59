// What a pixel visit knows beside the state, and what it asks of a backend.
//
// A backend supplies a Cost object per visited pixel with
//   void Photometric(const Plane* planes, int num_planes,
//                    const uint8_t* views, int num_views, float* costs) const;
//     costs[i * num_views + k] = matching cost of planes[i] in view views[k];
//     a batch, so that the backend can fill its lanes;
//   bool HasDepth(int view) const;
//     whether the view has a depth map (geometric passes only);
//   void GeometricErrors(const Plane* planes, int num_planes,
//                        const uint8_t* views, int num_views,
//                        float* errors) const;
//     reprojection errors in pixels, capped, in the same order; 0 in a view
//     without a depth map (geometric passes only).
#pragma once

#include "src/core/checkerboard.h"
#include "src/core/geometric_term.h"
#include "src/core/pixel_state.h"
#include "src/core/prior_term.h"
#include "src/core/view_selection.h"

#include <stdint.h>

namespace hpm {

struct VisitParams {
  Camera ref;
  int num_views;
  // Model units; hypotheses outside are not accepted.
  float depth_min, depth_max;
  int num_view_draws;         // 15
  float depth_perturbation;   // relative, 0.02
  float normal_perturbation;  // radians per axis, 0.01 pi
  float same_plane_bound;     // pixels; see NearlySame() in candidates.h
  float worst_cost;           // see WeightedMean()
  // Pixels in a source view per unit of -1/z, largest of all views.
  float parallax;
  int patch_radius;  // pixels
  bool geometric;    // add the geometric term
  GeometricTerm geometric_term;
  PriorTerm prior_term;
  int max_views;       // see KeepLargest()
  int max_candidates;  // regions that a visit looks into
  // Refinement without hypotheses from the whole depth range.
  bool search_near;
  bool ask_all_views;  // see ChooseViews()
  bool few_views;
};

// The visit of one pixel: where it is and what it reads.
struct PixelVisit {
  const VisitParams& params;
  const SamplingPattern& pattern;
  const PixelState& state;
  int iteration;
  int col, row;
  int at;     // index of the pixel
  Vec3f ray;  // through its centre, camera frame
};

HPM_HD PixelVisit VisitOf(const VisitParams& params,
                          const SamplingPattern& pattern,
                          const PixelState& state,
                          int iteration,
                          int col,
                          int row) {
  return {params,
          pattern,
          state,
          iteration,
          col,
          row,
          row * state.width + col,
          RayAt(params.ref, static_cast<float>(col), static_cast<float>(row))};
}

// k of the best-k mean at initialisation (paper, sections 3.2 and 4.1).
constexpr int kNumInitialViews = 4;

// Mean over the drawn views, weighted; costs[k] belongs to weights.view[k], or
// costs[weights.slot[k]] does. No cost counts more than `worst`: a view that
// does not see the plane at all, or shows the opposite of the reference, says
// no more than one that shows something else. Else a surface that few views see
// loses against a wrong one behind it that all do.
HPM_HD float WeightedMean(const ViewWeights& weights,
                          const float* costs,
                          bool by_slot,
                          float worst) {
  float sum = 0;
  for (int k = 0; k < weights.num_views; ++k) {
    const float cost = costs[by_slot ? weights.slot[k] : k];
    sum += weights.weight[k] * Smaller(cost, worst);
  }
  return sum / weights.weight_sum;
}

// WeightedMean() of several planes; costs[i * weights.num_views + k] is that of
// plane i in weights.view[k].
HPM_HD void MeanCosts(const VisitParams& params,
                      const ViewWeights& weights,
                      const float* costs,
                      int num_planes,
                      float* means) {
  for (int i = 0; i < num_planes; ++i) {
    means[i] = WeightedMean(
        weights, &costs[i * weights.num_views], false, params.worst_cost);
  }
}

// Photometric costs of several planes; the batch goes through the backend at
// once.
template <class Cost>
HPM_HD void PhotometricCosts(const VisitParams& params,
                             const Cost& cost,
                             const ViewWeights& weights,
                             const Plane* planes,
                             int num_planes,
                             float* means) {
  float costs[kNumRegions * kMaxViews];
  cost.Photometric(planes, num_planes, weights.view, weights.num_views, costs);
  MeanCosts(params, weights, costs, num_planes, means);
}

// In geometric passes adds the geometric term, which is never negative, to the
// photometric costs of several planes.
template <class Cost>
HPM_HD void AddGeometricTerms(const VisitParams& params,
                              const Cost& cost,
                              const ViewWeights& weights,
                              const Plane* planes,
                              int num_planes,
                              float* costs) {
  if (!params.geometric || num_planes == 0) return;
  float errors[kNumRegions * kMaxViews];
  cost.GeometricErrors(
      planes, num_planes, weights.view, weights.num_views, errors);
  for (int i = 0; i < num_planes; ++i) {
    costs[i] += params.geometric_term.weight *
                WeightedMean(weights,
                             &errors[i * weights.num_views],
                             false,
                             params.geometric_term.max_error);
  }
}

}  // namespace hpm
