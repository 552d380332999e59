// One plane hypothesis per pixel of a reference image, with what a run knows of
// it.
#pragma once

#include "src/core/pixel_state.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
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

  // Per pixel, how many iterations of the next pass visit it. Empty: all.
  std::vector<uint8_t> visits;

  // Halvings of the grid of `priors`; above 0 only for backends that upsample.
  int prior_level = 0;

  // Names the present planes, costs and masks: whatever has the same number has
  // the same contents, so a backend that holds them need not fetch them again.
  // Whoever changes them calls Touch() afterwards; a copy keeps the number.
  uint64_t generation = 0;  // 0: of no backend

  void Touch() {
    static std::atomic<uint64_t> last{0};
    generation = ++last;
  }

  HypothesisMap() = default;
  HypothesisMap(int w, int h) { Reset(w, h); }

  // As new, but in the memory it has: fresh memory is slow to come by. Planes
  // that were there stay for the caller to replace.
  void ResetAllButPlanes(int w, int h) {
    width = w;
    height = h;
    const size_t size = static_cast<size_t>(w) * h;
    planes.resize(size);
    costs.assign(size, kMaxCost);
    masks.assign(size, 0);
    priors.clear();
    unexplained.clear();
    visits.clear();
    prior_level = 0;
    Touch();
  }
  void Reset(int w, int h) {
    planes.clear();
    ResetAllButPlanes(w, h);
  }

  PixelState View() {
    return {width,
            height,
            planes.data(),
            costs.data(),
            masks.data(),
            priors.empty() ? nullptr : priors.data(),
            visits.empty() ? nullptr : visits.data()};
  }
};

}  // namespace hpm
