// One visit of one pixel: collect candidates, choose views, decide, refine
// (specification appendix A). The only function that changes a hypothesis.
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

// Higher is better; without a prior the order of the costs decides.
struct Ranking {
  const VisitParams* params;
  bool has_prior;
  float prior_depth;
  Vec3f prior_normal;

  HPM_HD_MEMBER float operator()(float cost,
                                 float depth,
                                 const Vec3f& normal) const {
    if (!has_prior) return -cost;
    return LogPosterior(
        params->prior_term, cost, depth, normal, prior_depth, prior_normal);
  }
};

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
  float z_random;
  Vec3f n_random;
  if (prior != nullptr) {
    const float prior_depth = -prior->distance / Dot(prior->normal, ray);
    z_random =
        prior_depth + rng->Uniform(-3.0f, 3.0f) * params.prior_term.sigma_depth;
    n_random = PerturbNormal(
        prior->normal, ray, 0.5f * params.prior_term.sigma_angle, rng);
  } else {
    z_random = rng->Uniform(params.depth_min, params.depth_max);
    n_random = RandomNormal(ray, rng);
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
                    z_random,
                    n_random,
                    z_perturbed,
                    n_perturbed,
                    planes);
  if (!params.search_near) {
    if (prior != nullptr) planes[0] = *prior;
    return kNumRefined;
  }
  int num_planes = 0;
  if (prior != nullptr) planes[num_planes++] = *prior;
  for (int i = kFirstNear; i < kNumRefined; ++i)
    planes[num_planes++] = planes[i];
  return num_planes;
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

  Ranking rank = {&params, false, 0, {0, 0, 0}};
  if (state.priors != nullptr && state.priors[at].distance > 0) {
    rank.has_prior = true;
    rank.prior_normal = state.priors[at].normal;
    rank.prior_depth = -state.priors[at].distance / Dot(rank.prior_normal, ray);
  }

  Plane best = state.planes[at];
  float best_cost;
  if (candidates.current != 0) {
    int same = 0;
    while (!(candidates.current >> same & 1)) ++same;
    best_cost = WeightedMean(
        weights, &candidates.matrix[same * candidates.num_views], true);
  } else {
    PhotometricCosts(cost, weights, &best, 1, &best_cost);
  }
  best_cost += GeometricCost(params, cost, weights, best);
  float best_rank =
      rank(best_cost, -best.distance / Dot(best.normal, ray), best.normal);
  bool propagated = false;

  // Candidates: their photometric costs are known already.
  for (int i = 0; i < kNumRegions; ++i) {
    if (!((candidates.exists & ~candidates.current) >> i & 1)) continue;
    const Plane& plane = candidates.plane[i];
    const float z = -plane.distance / Dot(plane.normal, ray);
    if (!(z >= params.depth_min && z <= params.depth_max)) continue;
    float candidate_cost = WeightedMean(
        weights, &candidates.matrix[i * candidates.num_views], true);
    // The geometric cost is never negative.
    if (!(rank(candidate_cost, z, plane.normal) > best_rank)) continue;
    candidate_cost += GeometricCost(params, cost, weights, plane);
    const float candidate_rank = rank(candidate_cost, z, plane.normal);
    if (candidate_rank > best_rank) {
      best = plane;
      best_cost = candidate_cost;
      best_rank = candidate_rank;
      propagated = true;
    }
  }

  Plane refined[kNumRefined];
  float refined_cost[kNumRefined];
  const int num_refined =
      RefinedPlanes(params,
                    best,
                    rank.has_prior ? &state.priors[at] : nullptr,
                    x,
                    y,
                    rng,
                    refined);
  PhotometricCosts(cost, weights, refined, num_refined, refined_cost);
  for (int i = 0; i < num_refined; ++i) {
    const float z = -refined[i].distance / Dot(refined[i].normal, ray);
    if (!(z >= params.depth_min && z <= params.depth_max)) continue;
    if (!(rank(refined_cost[i], z, refined[i].normal) > best_rank)) continue;
    refined_cost[i] += GeometricCost(params, cost, weights, refined[i]);
    const float refined_rank = rank(refined_cost[i], z, refined[i].normal);
    if (refined_rank > best_rank) {
      best = refined[i];
      best_cost = refined_cost[i];
      best_rank = refined_rank;
    }
  }

  state.planes[at] = best;
  state.costs[at] = best_cost;
  if (propagated) state.masks[at] = weights.mask;
}

}  // namespace hpm
