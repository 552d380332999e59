// A half-sweep, as data, and what it does at one pixel of its colour. A backend
// goes through VisitPixel(), or, where it computes the costs of several pixels
// at once, through the steps of update_pixel.h and initialize_pixel.h, so that
// a pass is the same on all of them.
#pragma once

#include "src/core/consistency_filter.h"
#include "src/core/initialize_pixel.h"
#include "src/core/median_filter.h"
#include "src/core/take_neighbour.h"
#include "src/core/update_pixel.h"

#include <stddef.h>
#include <stdint.h>

namespace hpm {

enum class SweepKind { kInitialize, kUpdate, kFollow, kMedian, kConsistency };
constexpr int kNumSweepKinds = static_cast<int>(SweepKind::kConsistency) + 1;

struct Sweep {
  SweepKind kind;
  int color;            // 0 or 1: parity of col + row
  uint64_t key;         // of the random numbers
  StartFrom start;      // kInitialize
  int iteration;        // kUpdate
  bool geometric;       // kUpdate, kConsistency
  FilterParams filter;  // kConsistency
};

// Whether the visits of a sweep are what its pass takes its time for.
inline bool CountsAsStep(SweepKind kind) {
  return kind == SweepKind::kInitialize || kind == SweepKind::kUpdate;
}

// One visit of a sweep that needs no matching cost.
HPM_HD void VisitPixel(const VisitParams& params,
                       const Sweep& sweep,
                       const PixelState& state,
                       int col,
                       int row) {
  if (sweep.kind == SweepKind::kFollow) {
    TakeNeighbour(params, state, col, row);
  } else {
    MedianFilterPixel(params.ref, state, col, row);
  }
}

// Whether a sweep leaves the pixel as it is.
HPM_HD bool PassesOver(const Sweep& sweep,
                       const PixelState& state,
                       int col,
                       int row) {
  if (sweep.kind != SweepKind::kUpdate || state.visits == nullptr) return false;
  const uint8_t visits = state.visits[row * state.width + col];
  return visits != kAllVisits && sweep.iteration >= visits;
}

// What a sweep is about, beside the pixel.
struct SweepScope {
  const VisitParams& params;  // `geometric` is that of the sweep
  const SamplingPattern& pattern;
  const Sweep& sweep;
  const PixelState& state;
  // For kConsistency alone.
  const Vec3f* src_centers;  // in the reference camera frame
  uint32_t* consistent;      // one mask per pixel
};

// One visit of a sweep that does.
template <SweepKind kKind, class Cost>
HPM_HD void VisitPixel(const SweepScope& scope,
                       const Cost& cost,
                       int col,
                       int row) {
  const auto& [params, pattern, sweep, state, src_centers, consistent] = scope;
  static_assert(kKind != SweepKind::kFollow && kKind != SweepKind::kMedian,
                "they need no cost");
  if constexpr (kKind == SweepKind::kConsistency) {
    const size_t at = static_cast<size_t>(row) * state.width + col;
    consistent[at] = ConsistentViews(
        params, sweep.filter, src_centers, cost, state.planes[at], col, row);
  } else {
    if (PassesOver(sweep, state, col, row)) return;
    Rng rng(sweep.key, col, row);
    if constexpr (kKind == SweepKind::kInitialize) {
      InitializePixel(params, state, sweep.start, cost, &rng, col, row);
    } else {
      UpdatePixel(VisitOf(params, pattern, state, sweep.iteration, col, row),
                  cost,
                  &rng);
    }
  }
}

}  // namespace hpm
