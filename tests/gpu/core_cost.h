// The Cost of a pixel visit on the device's tables with the matching cost as
// src/core states it: what the card's form is judged by.
#pragma once

#include "src/gpu/pixel_cost.h"
#include "src/gpu/samplers.h"

namespace hpm {

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
            view.height,
            view.has_gaps != 0);
      }
    }
    num_evaluations_ += num_planes * num_views;
  }

 private:
  const RefPatch& patch_;
};

}  // namespace hpm
