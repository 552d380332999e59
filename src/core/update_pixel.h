// One visit of one pixel: collect candidates, choose views, decide, refine
// (paper, section 3.2).
#pragma once

#include "src/core/candidates.h"
#include "src/core/refinement.h"

namespace hpm {

// Of the views that were asked, from the costs of the candidates and the votes
// of the neighbours.
HPM_HD void ViewProbabilities(const VisitParams& params,
                              const Candidates& candidates,
                              int iteration,
                              float probability[kMaxViews]) {
  const float good_cost = GoodCost(iteration);
  for (int j = 0; j < candidates.num_views; ++j) {
    probability[j] = candidates.votes[j] * ViewLikelihood(candidates.matrix,
                                                          candidates.num_views,
                                                          j,
                                                          candidates.exists,
                                                          good_cost);
  }
  KeepLargest(params.max_drawn_views, candidates.num_views, probability);
}

// What a hypothesis is worth beside its cost; nothing without a prior.
struct Bonus {
  const PriorTerm* term;
  const Plane* prior;  // null: none
  float prior_depth;

  HPM_HD_MEMBER float operator()(float depth, const Vec3f& normal) const {
    if (prior == nullptr) return 0;
    return PriorBonus(*term, depth, normal, prior_depth, prior->normal);
  }
};

// The best hypothesis so far.
struct Best {
  Plane plane;
  float cost;
  float bonus;

  // A hypothesis of this bonus is better if its cost lies below.
  HPM_HD_MEMBER float Limit(float other_bonus) const {
    return sqrtf(Larger(cost * cost + (other_bonus - bonus), 0.0f));
  }
};

// Takes the best of the planes if it is better; their photometric costs are
// known. Reorders planes and costs.
template <class Cost>
HPM_HD bool TakeBetter(const VisitParams& params,
                       const Cost& cost,
                       const ViewWeights& weights,
                       const Bonus& bonus,
                       const Vec3f& ray,
                       Plane* planes,
                       int num_planes,
                       float* costs,
                       Best* best) {
  // The geometric term only adds: who is not better without it is out.
  float bonuses[kNumRegions];
  int num_left = 0;
  for (int i = 0; i < num_planes; ++i) {
    const float z = -planes[i].distance / Dot(planes[i].normal, ray);
    if (!(z >= params.depth_min && z <= params.depth_max)) continue;
    const float plane_bonus = bonus(z, planes[i].normal);
    if (!(costs[i] < best->Limit(plane_bonus))) continue;
    planes[num_left] = planes[i];
    costs[num_left] = costs[i];
    bonuses[num_left++] = plane_bonus;
  }
  AddGeometricTerms(params, cost, weights, planes, num_left, costs);
  bool taken = false;
  for (int i = 0; i < num_left; ++i) {
    if (!(costs[i] < best->Limit(bonuses[i]))) continue;
    *best = {planes[i], costs[i], bonuses[i]};
    taken = true;
  }
  return taken;
}

// New hypotheses for the pixel at (x, y) whose plane is `best`; returns their
// number. `prior` may be null.
HPM_HD int RefinedPlanes(const VisitParams& params,
                         const Plane& best,
                         const Plane* prior,
                         float x,
                         float y,
                         Rng* rng,
                         Plane planes[kNumRefined]) {
  const Vec3f ray = RayAt(params.ref, x, y);
  const float depth = -best.distance / Dot(best.normal, ray);
  int num_planes = 0;
  if (params.search_near) {
    if (prior != nullptr) planes[num_planes++] = *prior;
  } else {
    float z_random;
    Vec3f n_random;
    if (prior != nullptr) {
      const float prior_depth = -prior->distance / Dot(prior->normal, ray);
      z_random = prior_depth +
                 rng->Uniform(-3.0f, 3.0f) * params.prior_term.sigma_depth;
      n_random = PerturbNormal(
          prior->normal, ray, 0.5f * params.prior_term.sigma_angle, rng);
    } else {
      z_random = rng->Uniform(params.depth_min, params.depth_max);
      n_random = RandomNormal(ray, rng);
    }
    CombineHypotheses(
        params.ref, x, y, depth, best.normal, z_random, n_random, planes);
    if (prior != nullptr) planes[0] = *prior;
    num_planes = kNumCombined;
  }
  const float z_perturbed = depth * rng->Uniform(1 - params.depth_perturbation,
                                                 1 + params.depth_perturbation);
  const Vec3f n_perturbed =
      PerturbNormal(best.normal, ray, params.normal_perturbation, rng);
  CombineHypotheses(params.ref,
                    x,
                    y,
                    depth,
                    best.normal,
                    z_perturbed,
                    n_perturbed,
                    planes + num_planes);
  return num_planes + kNumCombined;
}

template <class Cost>
HPM_HD void UpdatePixel(const VisitParams& params,
                        const SamplingPattern& pattern,
                        const PixelState& state,
                        const Cost& cost,
                        Rng* rng,
                        int iteration,
                        int col,
                        int row) {
  const int at = row * state.width + col;
  const float x = static_cast<float>(col);
  const float y = static_cast<float>(row);
  const Vec3f ray = RayAt(params.ref, x, y);

  Candidates candidates;
  CollectCandidates(params,
                    pattern,
                    state,
                    cost,
                    iteration,
                    rng->Uniform(),
                    col,
                    row,
                    &candidates);

  float probability[kMaxViews];
  ViewProbabilities(params, candidates, iteration, probability);
  const ViewWeights weights = DrawViews(probability,
                                        candidates.view,
                                        candidates.num_views,
                                        params.num_view_draws,
                                        rng->Uniform());

  const bool has_prior =
      state.priors != nullptr && state.priors[at].distance > 0;
  const Plane* prior = has_prior ? &state.priors[at] : nullptr;
  const Bonus bonus = {
      &params.prior_term,
      prior,
      has_prior ? -prior->distance / Dot(prior->normal, ray) : 0.0f};

  Best best = {state.planes[at], 0, 0};
  if (candidates.current != 0) {
    const int same = LowestBit(candidates.current);
    best.cost = WeightedMean(weights,
                             &candidates.matrix[same * candidates.num_views],
                             true,
                             params.worst_cost);
  } else {
    PhotometricCosts(params, cost, weights, &best.plane, 1, &best.cost);
  }
  AddGeometricTerms(params, cost, weights, &best.plane, 1, &best.cost);
  best.bonus = bonus(-best.plane.distance / Dot(best.plane.normal, ray),
                     best.plane.normal);

  // Candidates: their photometric costs are known already.
  static_assert(kNumRefined <= kNumRegions, "they share the arrays");
  Plane planes[kNumRegions];
  float costs[kNumRegions];
  int num_planes = 0;
  for (int i = 0; i < kNumRegions; ++i) {
    if (!((candidates.exists & ~candidates.current) >> i & 1)) continue;
    planes[num_planes] = candidates.plane[i];
    costs[num_planes++] =
        WeightedMean(weights,
                     &candidates.matrix[i * candidates.num_views],
                     true,
                     params.worst_cost);
  }
  const bool propagated = TakeBetter(
      params, cost, weights, bonus, ray, planes, num_planes, costs, &best);

  num_planes = RefinedPlanes(params, best.plane, prior, x, y, rng, planes);
  PhotometricCosts(params, cost, weights, planes, num_planes, costs);
  TakeBetter(
      params, cost, weights, bonus, ray, planes, num_planes, costs, &best);

  state.planes[at] = best.plane;
  state.costs[at] = best.cost;
  if (propagated) state.masks[at] = weights.mask;
}

}  // namespace hpm
