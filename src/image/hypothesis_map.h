// One plane hypothesis per pixel of a reference image, with what a run knows of
// it.
#pragma once

#include "src/core/pixel_state.h"

#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace hpm {

// Row-major, width * height entries each; reference camera frame, model units.
struct HypothesisMap {
  int width = 0;
  int height = 0;
  std::vector<Plane> planes;    // distance 0: no hypothesis yet
  std::vector<float> costs;     // see PixelState
  std::vector<uint32_t> masks;  // see PixelState
  std::vector<Plane>
      priors;  // empty: no priors; distance 0: none at this pixel

  // Set by passes with priors of regions, else empty; see MinedRegions. Such a
  // pixel has whatever plane matched best by chance, and all views may share
  // it, so that COLMAP's filter cannot tell.
  std::vector<bool> unexplained;

  // Halvings of the grid of `priors`; above 0 only for backends that upsample.
  int prior_level = 0;

  HypothesisMap() = default;
  HypothesisMap(int w, int h)
      : HypothesisMap(w,
                      h,
                      std::vector<Plane>(static_cast<size_t>(w) * h,
                                         Plane{{0, 0, 0}, 0})) {}
  HypothesisMap(int w, int h, std::vector<Plane> start)
      : width(w),
        height(h),
        planes(std::move(start)),
        costs(planes.size(), kMaxCost),
        masks(planes.size(), 0) {}

  PixelState View() {
    return {width,
            height,
            planes.data(),
            costs.data(),
            masks.data(),
            priors.empty() ? nullptr : priors.data()};
  }
};

}  // namespace hpm
