// The Cost of a pixel visit (see src/core/visit.h) in which the visitor
// computes its own pairs, one after the other.
#pragma once

#include "cuda/pair_cost.h"
#include "cuda/pixel_cost.h"

namespace hpm {

// With the card's form of the matching cost.
template <class Sampler>
class LaneCost : public PixelCost {
 public:
  HPM_HD_MEMBER LaneCost(const DeviceProblem& problem,
                         const Window& window,
                         int col,
                         int row)
      : PixelCost(problem, col, row), window_(window) {}

  HPM_HD_MEMBER void Photometric(const Plane* planes,
                                 int num_planes,
                                 const uint8_t* views,
                                 int num_views,
                                 float* costs) const {
    // One loop over all pairs: lanes of a warp differ in both numbers, and two
    // loops would each wait for the longest.
    const Sampler sampler(problem_);
    const int num_pairs = num_planes * num_views;
    PlaneSlope slope = {};
    for (int pair = 0, i = 0, k = 0; pair < num_pairs; ++pair) {
      if (k == 0) slope = SlopeOf(problem_.params.ref, planes[i]);
      costs[pair] = PairCost(problem_.shape,
                             window_,
                             problem_.views[views[k]],
                             views[k],
                             slope,
                             static_cast<float>(col_),
                             static_cast<float>(row_),
                             sampler);
      if (++k < num_views) continue;
      k = 0;
      ++i;
    }
    num_evaluations_ += num_planes * num_views;
  }

 private:
  const Window& window_;
};

// With the matching cost as src/core states it: the yardstick of the tests.
class CoreCost : public PixelCost {
 public:
  HPM_HD_MEMBER CoreCost(const DeviceProblem& problem,
                         const RefPatch& patch,
                         int col,
                         int row)
      : PixelCost(problem, col, row), patch_(patch) {}

  HPM_HD_MEMBER void Photometric(const Plane* planes,
                                 int num_planes,
                                 const uint8_t* views,
                                 int num_views,
                                 float* costs) const {
    const QuadSampler sampler(problem_);
    for (int i = 0; i < num_planes; ++i) {
      const PlaneSlope slope = SlopeOf(problem_.params.ref, planes[i]);
      for (int k = 0; k < num_views; ++k) {
        const ViewGeometry& view = problem_.views[views[k]];
        costs[i * num_views + k] = MatchCost(
            problem_.shape,
            patch_,
            WarpPatch(problem_.depth_views[views[k]].to_src,
                      slope,
                      static_cast<float>(col_),
                      static_cast<float>(row_)),
            [&](float u, float v) { return sampler(view, views[k], u, v); },
            view.width,
            view.height);
      }
    }
    num_evaluations_ += num_planes * num_views;
  }

 private:
  const RefPatch& patch_;
};

}  // namespace hpm
