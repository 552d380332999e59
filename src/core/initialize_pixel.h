// Start of a run at one pixel (paper, section 3.2, random initialisation; later
// runs start from what is stored or from a prior).
#pragma once

#include "src/core/pixel_state.h"
#include "src/core/refinement.h"
#include "src/core/visit.h"

namespace hpm {

enum class StartFrom {
  kRandom,   // random depth and normal
  kStored,   // the stored hypothesis at its stored cost: nothing to do
  kCurrent,  // the stored hypothesis
  kMissing,  // as kStored; a random one where none is stored
  kPrior,    // the prior, slightly perturbed, where there is one and the stored
             // cost is not credible; else the stored hypothesis
};

// Whether the start computes anything at a pixel with this stored hypothesis.
HPM_HD bool StartsAt(StartFrom start, const Plane& stored) {
  return start != StartFrom::kMissing || !(stored.distance > 0);
}

constexpr float kPriorDepthSpread = 0.06f;        // relative
constexpr float kPriorNormalSpread = 0.0942478f;  // radians per axis, 0.03 pi

// Mean of the best kNumInitialViews costs below kMaxCost and the mask of views
// with such a cost; costs[k] belongs to views[k]. kMaxCost and an empty mask if
// there is none.
HPM_HD float BestViewsCost(const float* costs,
                           const uint8_t* views,
                           int num_views,
                           uint32_t* mask) {
  float best[kNumInitialViews];
  int num_best = 0;
  for (int j = 0; j < num_views; ++j) {
    if (!(costs[j] < kMaxCost)) continue;
    int at = num_best < kNumInitialViews ? num_best++ : kNumInitialViews;
    if (at == kNumInitialViews) {
      if (costs[j] >= best[kNumInitialViews - 1]) continue;
      at = kNumInitialViews - 1;
    }
    for (; at > 0 && best[at - 1] > costs[j]; --at) best[at] = best[at - 1];
    best[at] = costs[j];
  }
  *mask = 0;
  if (num_best == 0) return kMaxCost;
  float sum = 0;
  for (int k = 0; k < num_best; ++k) sum += best[k];
  for (int j = 0; j < num_views; ++j) {
    if (costs[j] <= best[num_best - 1]) *mask |= 1u << views[j];
  }
  return sum / static_cast<float>(num_best);
}

// The views that a stored hypothesis is judged by. Stored hypotheses are those
// of a surface, so the second colour of the checkerboard asks the views that
// its neighbours of the first colour found good; all views where there are
// none.
HPM_HD uint32_t ViewsToAsk(const VisitParams& params,
                           const PixelState& state,
                           StartFrom start,
                           int col,
                           int row) {
  const uint32_t all = AllViews(params.num_views);
  if (start != StartFrom::kCurrent || params.ask_all_views ||
      (col + row) % 2 == 0) {
    return all;
  }
  const int at = row * state.width + col;
  uint32_t views = 0;
  if (row > 0) views |= state.masks[at - state.width];
  if (col > 0) views |= state.masks[at - 1];
  if (col + 1 < state.width) views |= state.masks[at + 1];
  if (row + 1 < state.height) views |= state.masks[at + state.width];
  return views != 0 ? views : all;
}

// The views of the mask; returns their number.
HPM_HD int ListViews(uint32_t mask, int num_all_views, uint8_t* views) {
  int num_views = 0;
  for (int j = 0; j < num_all_views; ++j) {
    if (mask >> j & 1) views[num_views++] = static_cast<uint8_t>(j);
  }
  return num_views;
}

// BestViewsCost() of the plane in the `asked` ones of the views.
template <class Cost>
HPM_HD float CostFromViews(const Cost& cost,
                           const Plane& plane,
                           uint32_t asked,
                           int num_all_views,
                           uint32_t* mask) {
  uint8_t views[kMaxViews] = {};
  const int num_views = ListViews(asked, num_all_views, views);
  float costs[kMaxViews];
  cost.Photometric(&plane, 1, views, num_views, costs);
  return BestViewsCost(costs, views, num_views, mask);
}

// A plane at one pixel.
struct PixelPlane {
  int col, row;
  Plane plane;
};

// `cost` is that of the pixel.
template <class Cost>
HPM_HD float CostFromAllViews(const VisitParams& params,
                              const Cost& cost,
                              const Plane& plane) {
  uint32_t mask;
  return CostFromViews(
      cost, plane, AllViews(params.num_views), params.num_views, &mask);
}

// What the pixel starts from, where StartsAt().
HPM_HD Plane StartPlane(const VisitParams& params,
                        const PixelState& state,
                        StartFrom start,
                        Rng* rng,
                        int col,
                        int row) {
  const int at = row * state.width + col;
  const Vec3f ray =
      RayAt(params.ref, static_cast<float>(col), static_cast<float>(row));
  // What a random start does not read need not be there.
  const Plane stored = start == StartFrom::kRandom ? Plane{} : state.planes[at];
  const bool has_plane = stored.distance > 0;
  if (start == StartFrom::kPrior && state.priors != nullptr &&
      state.priors[at].distance > 0 &&
      !(has_plane && state.costs[at] < kCredibleCost)) {
    const Plane& prior = state.priors[at];
    const Vec3f normal =
        PerturbNormal(prior.normal, ray, kPriorNormalSpread, rng);
    const float depth =
        DepthOnRay(prior, ray) *
        rng->Uniform(1 - kPriorDepthSpread, 1 + kPriorDepthSpread);
    return PlaneOnRay(ray, depth, normal);
  }
  if (start == StartFrom::kRandom || !has_plane) {
    const Vec3f normal = RandomNormal(ray, rng);
    return PlaneOnRay(
        ray, rng->Uniform(params.depth_min, params.depth_max), normal);
  }
  return stored;
}

template <class Cost>
HPM_HD void InitializePixel(const VisitParams& params,
                            const PixelState& state,
                            StartFrom start,
                            const Cost& cost,
                            Rng* rng,
                            int col,
                            int row) {
  const int at = row * state.width + col;
  if (start != StartFrom::kRandom && !StartsAt(start, state.planes[at])) return;
  const Plane plane = StartPlane(params, state, start, rng, col, row);
  state.planes[at] = plane;
  state.costs[at] = CostFromViews(cost,
                                  plane,
                                  ViewsToAsk(params, state, start, col, row),
                                  params.num_views,
                                  &state.masks[at]);
}

}  // namespace hpm
