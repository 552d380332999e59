// What the costs of a pixel on a card share: where it is, the sources' depth,
// the count of evaluations.
#pragma once

#include "src/gpu/device_problem.h"

namespace hpm {

// A Cost (see src/core/visit.h) but for Photometric().
class PixelCost {
 public:
  HPM_HD_MEMBER PixelCost(const DeviceProblem& problem, int col, int row)
      : problem_(problem), col_(col), row_(row) {}

  HPM_HD_MEMBER bool HasDepth(int view) const {
    return problem_.depth_views[view].HasDepth();
  }

  HPM_HD_MEMBER void GeometricErrors(const Plane* planes,
                                     int num_planes,
                                     const uint8_t* views,
                                     int num_views,
                                     float* errors) const {
    hpm::GeometricErrors(problem_.params.ref,
                         problem_.depth_views,
                         problem_.params.geometric_term.max_error,
                         col_,
                         row_,
                         planes,
                         num_planes,
                         views,
                         num_views,
                         errors);
  }

  HPM_HD_MEMBER int num_evaluations() const { return num_evaluations_; }

 protected:
  const DeviceProblem& problem_;
  int col_, row_;
  mutable int num_evaluations_ = 0;
};

}  // namespace hpm
