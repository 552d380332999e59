// Cost objects for tests of the decisions: any function of plane and view.
#pragma once

#include "src/core/visit.h"

#include <functional>

namespace hpm {

struct FakeCost {
  std::function<float(const Plane&, int view)> photometric;
  std::function<float(const Plane&, int view)> geometric =
      [](const Plane&, int) { return 0.0f; };
  uint32_t without_depth = 0;  // bit j: view j has no depth map
  mutable int num_evaluations = 0;

  void Photometric(const Plane* planes,
                   int num_planes,
                   const uint8_t* views,
                   int num_views,
                   float* costs) const {
    for (int i = 0; i < num_planes; ++i) {
      for (int k = 0; k < num_views; ++k) {
        costs[i * num_views + k] = photometric(planes[i], views[k]);
      }
    }
    num_evaluations += num_planes * num_views;
  }
  bool HasDepth(int view) const { return (without_depth >> view & 1) == 0; }
  void GeometricErrors(const Plane* planes,
                       int num_planes,
                       const uint8_t* views,
                       int num_views,
                       float* errors) const {
    for (int i = 0; i < num_planes; ++i) {
      for (int k = 0; k < num_views; ++k) {
        errors[i * num_views + k] =
            HasDepth(views[k]) ? geometric(planes[i], views[k]) : 0.0f;
      }
    }
  }
};

}  // namespace hpm
