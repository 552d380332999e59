// A prior of a coarser level, upsampled at one pixel: the work of a lane.
#pragma once

#include "src/core/upsample_plane.h"
#include "src/gpu/device_problem.h"

namespace hpm {

// The reference image guides.
HPM_HD Plane UpsampledPriorAt(const DeviceProblem& problem,
                              const Plane* low,
                              int level,
                              int col,
                              int row) {
  const int width = problem.params.ref.width;
  return UpsamplePlaneAt(
      low,
      level,
      problem.params.ref,
      [&](int c, int r) {
        return problem.ref_grey[static_cast<size_t>(r) * width + c];
      },
      [](float dx, float dy) { return UpsampleSpatialWeight(dx, dy); },
      [](int d) { return UpsampleColorWeight(d); },
      problem.params.depth_min,
      problem.params.depth_max,
      col,
      row);
}

}  // namespace hpm
