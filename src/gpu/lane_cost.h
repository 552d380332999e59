// The Cost of a pixel visit (see src/core/visit.h) on a card: a lane computes
// the pairs of its pixel one after the other, with the card's form of the
// matching cost.
#pragma once

#include "src/gpu/pair_cost.h"
#include "src/gpu/pixel_cost.h"

namespace hpm {

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
    // One loop over all pairs: lanes of a warp differ in both numbers.
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

}  // namespace hpm
