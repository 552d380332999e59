// One visit of one pixel: collect candidates, choose views, decide, refine
// (specification appendix A). The only function that changes a hypothesis.
#pragma once

#include "src/core/candidates.h"
#include "src/core/refinement.h"

namespace hpm {

// View probabilities from the candidates' votes and the masks of four
// neighbours of the other colour.
HPM_HD void ViewProbabilities(const VisitParams& params,
                              const SamplingPattern& pattern,
                              const PixelState& state,
                              const Candidates& candidates,
                              int iteration,
                              int col,
                              int row,
                              float probability[kMaxViews]) {
  const float good_cost = GoodCost(iteration);
  float neighbour_votes[kMaxViews];
  for (int j = 0; j < params.num_views; ++j) neighbour_votes[j] = 0;
  const int d = pattern.mask_distance;
  const int dcol[4] = {0, 0, -d, d};
  const int drow[4] = {-d, d, 0, 0};
  for (int b = 0; b < 4; ++b) {
    const int c = col + dcol[b];
    const int r = row + drow[b];
    if (c < 0 || r < 0 || c >= state.width || r >= state.height) continue;
    const uint32_t mask = state.masks[r * state.width + c];
    for (int j = 0; j < params.num_views; ++j) {
      neighbour_votes[j] += (mask >> j & 1) ? 0.9f : 0.1f;
    }
  }
  for (int j = 0; j < params.num_views; ++j) {
    probability[j] = neighbour_votes[j] * ViewLikelihood(candidates.matrix,
                                                         params.num_views,
                                                         j,
                                                         candidates.exists,
                                                         good_cost);
  }
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
  CollectCandidates(
      params, pattern, state, cost, iteration, col, row, &candidates);

  float probability[kMaxViews];
  ViewProbabilities(
      params, pattern, state, candidates, iteration, col, row, probability);
  const ViewWeights weights = DrawViews(
      probability, params.num_views, params.num_view_draws, rng->Uniform());

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
        weights, &candidates.matrix[same * params.num_views], true);
  } else {
    PhotometricCosts(cost, weights, &best, 1, &best_cost);
  }
  best_cost += GeometricCost(params, cost, weights, best);
  float depth = -best.distance / Dot(best.normal, ray);
  float best_rank = rank(best_cost, depth, best.normal);
  bool propagated = false;

  // Candidates: their photometric costs are known already.
  for (int i = 0; i < kNumRegions; ++i) {
    if (!((candidates.exists & ~candidates.current) >> i & 1)) continue;
    const Plane& plane = candidates.plane[i];
    const float z = -plane.distance / Dot(plane.normal, ray);
    if (!(z >= params.depth_min && z <= params.depth_max)) continue;
    float candidate_cost =
        WeightedMean(weights, &candidates.matrix[i * params.num_views], true);
    // The geometric term can only add to the cost.
    if (!(rank(candidate_cost, z, plane.normal) > best_rank)) continue;
    candidate_cost += GeometricCost(params, cost, weights, plane);
    const float candidate_rank = rank(candidate_cost, z, plane.normal);
    if (candidate_rank > best_rank) {
      best = plane;
      best_cost = candidate_cost;
      best_rank = candidate_rank;
      depth = z;
      propagated = true;
    }
  }

  // Refinement: all combinations start from the plane accepted so far.
  float z_random;
  Vec3f n_random;
  if (rank.has_prior) {
    z_random = rank.prior_depth +
               rng->Uniform(-3.0f, 3.0f) * params.prior_term.sigma_depth;
    n_random = PerturbNormal(
        rank.prior_normal, ray, 0.5f * params.prior_term.sigma_angle, rng);
  } else {
    z_random = rng->Uniform(params.depth_min, params.depth_max);
    n_random = RandomNormal(ray, rng);
  }
  const float z_perturbed = depth * rng->Uniform(1 - params.depth_perturbation,
                                                 1 + params.depth_perturbation);
  const Vec3f n_perturbed =
      PerturbNormal(best.normal, ray, params.normal_perturbation, rng);
  Plane refined[kNumRefined];
  float refined_cost[kNumRefined];
  CombineHypotheses(params.ref,
                    x,
                    y,
                    depth,
                    best.normal,
                    z_random,
                    n_random,
                    z_perturbed,
                    n_perturbed,
                    refined);
  PhotometricCosts(cost, weights, refined, kNumRefined, refined_cost);
  for (int i = 0; i < kNumRefined; ++i) {
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
