// The Cost of a pixel visit (see src/core/visit.h) in which the visitor
// computes its own pairs, one after the other.
#pragma once

#include "cuda/pair_cost.h"

namespace hpm {

// With the card's form of the matching cost.
template <class Sampler>
class DirectCost {
 public:
  HPM_HD_MEMBER DirectCost(const DeviceProblem& problem,
                           const Window& window,
                           int col,
                           int row)
      : problem_(problem), window_(window), col_(col), row_(row) {}

  HPM_HD_MEMBER void Photometric(const Plane* planes,
                                 int num_planes,
                                 const uint8_t* views,
                                 int num_views,
                                 float* costs) const {
    const Sampler sampler(problem_);
    for (int i = 0; i < num_planes; ++i) {
      const PlaneSlope slope = SlopeOf(problem_.params.ref, planes[i]);
      for (int k = 0; k < num_views; ++k) {
        costs[i * num_views + k] = PairCost(problem_.shape,
                                            window_,
                                            problem_.views[views[k]],
                                            views[k],
                                            slope,
                                            static_cast<float>(col_),
                                            static_cast<float>(row_),
                                            sampler);
      }
    }
    num_evaluations_ += num_planes * num_views;
  }

  HPM_HD_MEMBER bool HasDepth(int view) const {
    return HasDepthMap(problem_, view);
  }
  HPM_HD_MEMBER void GeometricErrors(const Plane* planes,
                                     int num_planes,
                                     const uint8_t* views,
                                     int num_views,
                                     float* errors) const {
    GeometricErrorsAt(
        problem_, planes, num_planes, views, num_views, col_, row_, errors);
  }

  HPM_HD_MEMBER int num_evaluations() const { return num_evaluations_; }

 private:
  const DeviceProblem& problem_;
  const Window& window_;
  int col_, row_;
  mutable int num_evaluations_ = 0;
};

// With the matching cost as src/core states it: the yardstick of the tests.
class CoreCost {
 public:
  HPM_HD_MEMBER CoreCost(const DeviceProblem& problem,
                         const RefPatch& patch,
                         int col,
                         int row)
      : problem_(problem), patch_(patch), col_(col), row_(row) {}

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
            WarpPatch(problem_.to_src[views[k]],
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

  HPM_HD_MEMBER bool HasDepth(int view) const {
    return HasDepthMap(problem_, view);
  }
  HPM_HD_MEMBER void GeometricErrors(const Plane* planes,
                                     int num_planes,
                                     const uint8_t* views,
                                     int num_views,
                                     float* errors) const {
    GeometricErrorsAt(
        problem_, planes, num_planes, views, num_views, col_, row_, errors);
  }

  HPM_HD_MEMBER int num_evaluations() const { return num_evaluations_; }

 private:
  const DeviceProblem& problem_;
  const RefPatch& patch_;
  int col_, row_;
  mutable int num_evaluations_ = 0;
};

}  // namespace hpm
