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
  KeepLargest(params.max_views, candidates.num_views, probability);
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

// All that decides between hypotheses of one visit.
template <class Cost>
struct Judge {
  const PixelVisit& visit;
  const Cost& cost;
  const ViewWeights& weights;
  Bonus bonus;
};

// Takes the best of the planes if it is better; their photometric costs are
// known. Reorders planes and costs.
template <class Cost>
HPM_HD bool TakeBetter(const Judge<Cost>& judge,
                       Plane* planes,
                       int num_planes,
                       float* costs,
                       Best* best) {
  const VisitParams& params = judge.visit.params;
  // The geometric term only adds: who is not better without it is out.
  float bonuses[kNumRegions];
  int num_left = 0;
  for (int i = 0; i < num_planes; ++i) {
    const float z = DepthOnRay(planes[i], judge.visit.ray);
    if (!(z >= params.depth_min && z <= params.depth_max)) continue;
    const float plane_bonus = judge.bonus(z, planes[i].normal);
    if (!(costs[i] < best->Limit(plane_bonus))) continue;
    planes[num_left] = planes[i];
    costs[num_left] = costs[i];
    bonuses[num_left++] = plane_bonus;
  }
  AddGeometricTerms(params, judge.cost, judge.weights, planes, num_left, costs);
  bool taken = false;
  for (int i = 0; i < num_left; ++i) {
    if (!(costs[i] < best->Limit(bonuses[i]))) continue;
    *best = {planes[i], costs[i], bonuses[i]};
    taken = true;
  }
  return taken;
}

// New hypotheses for the pixel whose plane is `best`; returns their number.
// `prior` may be null.
HPM_HD int RefinedPlanes(const PixelVisit& visit,
                         const Plane& best,
                         const Plane* prior,
                         Rng* rng,
                         Plane planes[kNumRefined]) {
  const VisitParams& params = visit.params;
  const Vec3f& ray = visit.ray;
  const float depth = DepthOnRay(best, ray);
  int num_planes = 0;
  if (params.search_near) {
    if (prior != nullptr) planes[num_planes++] = *prior;
  } else {
    float z_random;
    Vec3f n_random;
    if (prior != nullptr) {
      z_random = DepthOnRay(*prior, ray) +
                 rng->Uniform(-3.0f, 3.0f) * params.prior_term.sigma_depth;
      n_random = PerturbNormal(
          prior->normal, ray, 0.5f * params.prior_term.sigma_angle, rng);
    } else {
      z_random = rng->Uniform(params.depth_min, params.depth_max);
      n_random = RandomNormal(ray, rng);
    }
    CombineHypotheses(ray, depth, best.normal, z_random, n_random, planes);
    if (prior != nullptr) planes[0] = *prior;
    num_planes = kNumCombined;
  }
  const float z_perturbed = depth * rng->Uniform(1 - params.depth_perturbation,
                                                 1 + params.depth_perturbation);
  const Vec3f n_perturbed =
      PerturbNormal(best.normal, ray, params.normal_perturbation, rng);
  CombineHypotheses(
      ray, depth, best.normal, z_perturbed, n_perturbed, planes + num_planes);
  return num_planes + kNumCombined;
}

template <class Cost>
HPM_HD void UpdatePixel(const PixelVisit& visit, const Cost& cost, Rng* rng) {
  const VisitParams& params = visit.params;
  const PixelState& state = visit.state;
  Candidates candidates;
  CollectCandidates(visit, cost, rng->Uniform(), &candidates);

  float probability[kMaxViews];
  ViewProbabilities(params, candidates, visit.iteration, probability);
  const ViewWeights weights = DrawViews(probability,
                                        candidates.view,
                                        candidates.num_views,
                                        params.num_view_draws,
                                        rng->Uniform());

  const bool has_prior =
      state.priors != nullptr && state.priors[visit.at].distance > 0;
  const Plane* prior = has_prior ? &state.priors[visit.at] : nullptr;
  const Judge<Cost> judge = {
      visit,
      cost,
      weights,
      {&params.prior_term,
       prior,
       has_prior ? DepthOnRay(*prior, visit.ray) : 0.0f}};

  Best best = {state.planes[visit.at], 0, 0};
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
  best.bonus =
      judge.bonus(DepthOnRay(best.plane, visit.ray), best.plane.normal);

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
  const bool propagated = TakeBetter(judge, planes, num_planes, costs, &best);

  num_planes = RefinedPlanes(visit, best.plane, prior, rng, planes);
  PhotometricCosts(params, cost, weights, planes, num_planes, costs);
  TakeBetter(judge, planes, num_planes, costs, &best);

  state.planes[visit.at] = best.plane;
  state.costs[visit.at] = best.cost;
  if (propagated) state.masks[visit.at] = weights.mask;
}

}  // namespace hpm
