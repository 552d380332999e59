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

// A visit once its candidates are known.
struct PixelUpdate {
  ViewWeights weights;
  Best best;
  bool propagated;  // `best` is one of the candidates
  // Refined hypotheses.
  int num_planes;
  Plane planes[kNumRefined];
};

// Chooses the views that decide; returns whether the cost of the stored
// hypothesis, update->best.plane, must be evaluated in them.
HPM_HD bool ChooseWeights(const PixelVisit& visit,
                          const Candidates& candidates,
                          Rng* rng,
                          PixelUpdate* update) {
  const VisitParams& params = visit.params;
  float probability[kMaxViews];
  ViewProbabilities(params, candidates, visit.iteration, probability);
  update->weights = DrawViews(probability,
                              candidates.view,
                              candidates.num_views,
                              params.num_view_draws,
                              rng->Uniform());
  update->best = {visit.state.planes[visit.at], 0, 0};
  return candidates.current == 0;
}

// The prior of the pixel; null if it has none.
HPM_HD const Plane* PriorOf(const PixelVisit& visit) {
  const PixelState& state = visit.state;
  const bool has_prior =
      state.priors != nullptr && state.priors[visit.at].distance > 0;
  return has_prior ? &state.priors[visit.at] : nullptr;
}

template <class Cost>
HPM_HD Judge<Cost> JudgeOf(const PixelVisit& visit,
                           const Cost& cost,
                           const PixelUpdate& update) {
  const Plane* prior = PriorOf(visit);
  return {visit,
          cost,
          update.weights,
          {&visit.params.prior_term,
           prior,
           prior != nullptr ? DepthOnRay(*prior, visit.ray) : 0.0f}};
}

// Takes the best of the candidates, whose photometric costs are known, and
// proposes refined hypotheses. `costs`: of the stored hypothesis in the views
// of the weights, where ChooseWeights() asked for it.
template <class Cost>
HPM_HD void Propagate(const PixelVisit& visit,
                      const Cost& cost,
                      const Candidates& candidates,
                      const float* costs,
                      Rng* rng,
                      PixelUpdate* update) {
  const VisitParams& params = visit.params;
  const ViewWeights& weights = update->weights;
  const Judge<Cost> judge = JudgeOf(visit, cost, *update);
  Best& best = update->best;
  const bool is_candidate = candidates.current != 0;
  if (is_candidate) {
    const int same = LowestBit(candidates.current);
    costs = &candidates.matrix[same * candidates.num_views];
  }
  best.cost = WeightedMean(weights, costs, is_candidate, params.worst_cost);
  AddGeometricTerms(params, cost, weights, &best.plane, 1, &best.cost);
  best.bonus =
      judge.bonus(DepthOnRay(best.plane, visit.ray), best.plane.normal);

  Plane planes[kNumRegions];
  float plane_costs[kNumRegions];
  int num_planes = 0;
  for (int i = 0; i < kNumRegions; ++i) {
    if (!((candidates.exists & ~candidates.current) >> i & 1)) continue;
    planes[num_planes] = candidates.plane[i];
    plane_costs[num_planes++] =
        WeightedMean(weights,
                     &candidates.matrix[i * candidates.num_views],
                     true,
                     params.worst_cost);
  }
  update->propagated =
      TakeBetter(judge, planes, num_planes, plane_costs, &best);
  update->num_planes =
      RefinedPlanes(visit, best.plane, judge.bonus.prior, rng, update->planes);
}

// Takes the best of the refined hypotheses, whose MeanCosts() these are, and
// stores the result.
template <class Cost>
HPM_HD void FinishUpdate(const PixelVisit& visit,
                         const Cost& cost,
                         float* means,
                         PixelUpdate* update) {
  const PixelState& state = visit.state;
  TakeBetter(JudgeOf(visit, cost, *update),
             update->planes,
             update->num_planes,
             means,
             &update->best);
  state.planes[visit.at] = update->best.plane;
  state.costs[visit.at] = update->best.cost;
  if (update->propagated) state.masks[visit.at] = update->weights.mask;
}

// The visit as a whole, for a backend that answers each batch at once.
template <class Cost>
HPM_HD void UpdatePixel(const PixelVisit& visit, const Cost& cost, Rng* rng) {
  Candidates candidates;
  CollectCandidates(visit, cost, rng->Uniform(), &candidates);
  PixelUpdate update;
  const ViewWeights& weights = update.weights;
  float costs[kMaxViews];
  if (ChooseWeights(visit, candidates, rng, &update)) {
    cost.Photometric(
        &update.best.plane, 1, weights.view, weights.num_views, costs);
  }
  Propagate(visit, cost, candidates, costs, rng, &update);
  float means[kNumRefined];
  PhotometricCosts(
      visit.params, cost, weights, update.planes, update.num_planes, means);
  FinishUpdate(visit, cost, means, &update);
}

}  // namespace hpm
