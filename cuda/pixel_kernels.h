// What a kernel does at one pixel: the decisions of src/core, fed with the
// problem, the state and a Cost. The kernels in kernels.cu and the host tests
// call these, so that what a test saw on the host is what a card runs.
#pragma once

#include "cuda/device_problem.h"
#include "src/core/consistency_filter.h"
#include "src/core/initialize_pixel.h"
#include "src/core/median_filter.h"
#include "src/core/take_neighbour.h"
#include "src/core/update_pixel.h"
#include "src/core/upsample_plane.h"

namespace hpm {

// A half-sweep of one kind, as data.
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

// One visit. `problem.params.geometric` is that of the sweep. `consistent`: for
// kConsistency, one mask per pixel.
template <SweepKind kKind, class Cost>
HPM_HD void VisitPixel(const DeviceProblem& problem,
                       const Sweep& sweep,
                       const PixelState& state,
                       uint32_t* consistent,
                       const Cost& cost,
                       int col,
                       int row) {
  static_assert(kKind != SweepKind::kFollow && kKind != SweepKind::kMedian,
                "TakeNeighbour and MedianFilterPixel need no cost");
  if constexpr (kKind == SweepKind::kConsistency) {
    const size_t at = static_cast<size_t>(row) * state.width + col;
    consistent[at] = ConsistentViews(problem.params,
                                     sweep.filter,
                                     problem.src_centers,
                                     cost,
                                     state.planes[at],
                                     col,
                                     row);
  } else {
    Rng rng(sweep.key, col, row);
    if constexpr (kKind == SweepKind::kInitialize) {
      InitializePixel(problem.params, state, sweep.start, cost, &rng, col, row);
    } else {
      UpdatePixel(problem.params,
                  problem.pattern,
                  state,
                  cost,
                  &rng,
                  sweep.iteration,
                  col,
                  row);
    }
  }
}

// A prior of a coarser level at one pixel; the reference image guides.
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
