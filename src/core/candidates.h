// Candidate hypotheses of a visit: in each region the pixel of smallest stored
// cost; regions whose candidate convinces no view grow (NESP, paper,
// section 3.2).
#pragma once

#include "src/core/visit.h"

#include <math.h>
#include <stdint.h>
#include <string.h>

namespace hpm {

struct Candidates {
  Plane plane[kNumRegions];
  uint32_t exists;   // bit i: region i has a sample inside the image
  uint32_t current;  // bit i: candidate i is nearly the current hypothesis
  int num_views;     // that were asked
  uint8_t view[kMaxViews];
  float votes[kMaxViews];                 // of the neighbours for view[k]
  float matrix[kNumRegions * kMaxViews];  // [region * num_views + k]: view[k]
};

// Takes away views of fewest votes, from view `turn` on, until `count` are
// left.
HPM_HD uint32_t MostVoted(uint32_t views,
                          const uint32_t votes[kMaxViews],
                          int num_views,
                          int count,
                          int turn) {
  int num_left = 0;
  for (int j = 0; j < num_views; ++j) num_left += views >> j & 1;
  for (; num_left > count; --num_left) {
    int least = -1;
    for (int i = 0; i < num_views; ++i) {
      const int j = turn + i < num_views ? turn + i : turn + i - num_views;
      if ((views >> j & 1) && (least < 0 || votes[j] < votes[least])) least = j;
    }
    views &= ~(1u << least);
  }
  return views;
}

// Views worth asking, with the votes of the neighbours: with `ask_all_views`,
// as the paper does, all; else those that the pixel itself or two of its
// neighbours trusted, and one more in turn, so that a view can come back; with
// `few_views` the most voted of those that the pixel has just trusted. One at
// least.
HPM_HD void ChooseViews(const PixelVisit& visit,
                        float draw,
                        Candidates* candidates) {
  const VisitParams& params = visit.params;
  const PixelState& state = visit.state;
  uint32_t trusted =
      params.ask_all_views ? AllViews(params.num_views) : state.masks[visit.at];
  uint32_t once = trusted;
  uint32_t votes[kMaxViews] = {};
  int num_voters = 0;
  const int d = visit.pattern.mask_distance;
  const int dcol[4] = {0, 0, -d, d};
  const int drow[4] = {-d, d, 0, 0};
  for (int b = 0; b < 4; ++b) {
    const int c = visit.col + dcol[b];
    const int r = visit.row + drow[b];
    if (c < 0 || r < 0 || c >= state.width || r >= state.height) continue;
    const uint32_t mask = state.masks[r * state.width + c];
    for (int j = 0; j < params.num_views; ++j) votes[j] += mask >> j & 1;
    if (!params.few_views) trusted |= once & mask;
    once |= mask;
    ++num_voters;
  }
  int turn = static_cast<int>(draw * static_cast<float>(params.num_views));
  if (turn == params.num_views) turn = 0;  // rounding
  if (!params.few_views || trusted == 0) trusted |= 1u << turn;
  if (params.few_views) {
    trusted =
        MostVoted(trusted, votes, params.num_views, params.max_views, turn);
  }
  candidates->num_views = 0;
  for (int j = 0; j < params.num_views; ++j) {
    if (!(trusted >> j & 1)) continue;
    candidates->votes[candidates->num_views] =
        0.1f * static_cast<float>(num_voters) +
        0.8f * static_cast<float>(votes[j]);
    candidates->view[candidates->num_views++] = static_cast<uint8_t>(j);
  }
}

// Slopes of the candidates, as structure of arrays.
struct CandidateSlopes {
  float col[kNumRegions], row[kNumRegions], constant[kNumRegions];
};

// Bit j: candidate j and `plane` put the samples of the patch less than the
// bound apart, to first order and for a source camera at the distance of the
// reference: then they share one row of costs. Converged neighbourhoods hold
// copies of planes. No branch: nothing could predict one.
HPM_HD uint32_t NearlySame(const VisitParams& params,
                           const CandidateSlopes& slopes,
                           const PlaneSlope& plane,
                           float col,
                           float row) {
  const float radius = static_cast<float>(params.patch_radius);
  uint32_t same = 0;
  for (int j = 0; j < kNumRegions; ++j) {
    const float dcol = slopes.col[j] - plane.col;
    const float drow = slopes.row[j] - plane.row;
    const float here =
        dcol * col + drow * row + slopes.constant[j] - plane.constant;
    const float apart =
        (fabsf(here) + radius * (fabsf(dcol) + fabsf(drow))) * params.parallax;
    same |= static_cast<uint32_t>(apart < params.same_plane_bound) << j;
  }
  return same;
}

HPM_HD int LowestBit(uint32_t bits) {
  int i = 0;
  while (!(bits >> i & 1)) ++i;
  return i;
}

// Costs are not negative: their order is the order of their bits.
HPM_HD uint64_t CostKey(float cost, int k) {
  uint32_t bits;
  memcpy(&bits, &cost, sizeof(bits));
  return static_cast<uint64_t>(bits) << 32 | static_cast<uint32_t>(k);
}

// Best sample among offsets [begin, end) of a region, -1 if none is inside the
// image or better than *best_cost.
HPM_HD int BestSample(
    const PixelVisit& visit, int region, int begin, int end, float* best_cost) {
  const PixelState& state = visit.state;
  const short* dcol = visit.pattern.dcol[region];
  const short* drow = visit.pattern.drow[region];
  // The smallest key needs no branch; nothing could predict one.
  const uint64_t none = CostKey(*best_cost, 0);
  uint64_t best = none;
  for (int k = begin; k < end; ++k) {
    const int c = visit.col + dcol[k];
    const int r = visit.row + drow[k];
    // The V of the local pattern alternates between its arms: one of them may
    // leave the image before the other.
    if (static_cast<unsigned>(c) >= static_cast<unsigned>(state.width) ||
        static_cast<unsigned>(r) >= static_cast<unsigned>(state.height)) {
      continue;
    }
    const uint64_t key = CostKey(state.costs[r * state.width + c], k);
    best = key < best ? key : best;
  }
  if (best == none) return -1;
  const int k = static_cast<int>(best & 0xffffffffu);
  const int at = (visit.row + drow[k]) * state.width + visit.col + dcol[k];
  *best_cost = state.costs[at];
  return at;
}

// tau(t_iter, t_ext) of the paper: a cost below it speaks for a candidate.
HPM_HD float Tau(int iteration, int extension) {
  return 0.8f * expf(-static_cast<float>(iteration * iteration *
                                         (kMaxExtensions - extension)) /
                     90.0f);
}

// The paper's test whether a region must grow: fewer than one view below the
// threshold, or more than two views above the bad cost.
HPM_HD bool MustExtend(const float* costs, int num_views, float tau) {
  constexpr int kNumGood = 1, kNumBad = 2;
  int num_good = 0, num_bad = 0;
  for (int j = 0; j < num_views; ++j) {
    num_good += costs[j] < tau;
    num_bad += costs[j] > kBadCost;
  }
  return num_good < kNumGood || num_bad > kNumBad;
}

// Takes away the regions of largest cost until `count` are left.
HPM_HD uint32_t CheapestRegions(const float* costs,
                                uint32_t exists,
                                int count) {
  int num_regions = 0;
  for (int i = 0; i < kNumRegions; ++i) num_regions += exists >> i & 1;
  for (; num_regions > count; --num_regions) {
    int worst = -1;
    for (int i = 0; i < kNumRegions; ++i) {
      if ((exists >> i & 1) && (worst < 0 || costs[i] > costs[worst]))
        worst = i;
    }
    exists &= ~(1u << worst);
  }
  return exists;
}

// What the steps of CollectCandidates() hand on, by region.
struct RegionSamples {
  int count[kNumRegions];        // samples looked at
  float best_cost[kNumRegions];  // of them
  int best[kNumRegions];         // index of its pixel; -1: none in the image
  // Its plane is nearly that of this region, whose row of costs it shares.
  int same_as[kNumRegions];
};

// Planes to be evaluated at once, each for its region.
struct CandidateBatch {
  int size;
  uint8_t region[kNumRegions];
  Plane plane[kNumRegions];

  HPM_HD_MEMBER void Add(int i, const Plane& candidate) {
    region[size] = static_cast<uint8_t>(i);
    plane[size++] = candidate;
  }
};

// First step: the pixel of smallest cost in each region, and the regions that
// the visit looks into.
HPM_HD void SampleRegions(const PixelVisit& visit,
                          RegionSamples* samples,
                          Candidates* candidates) {
  candidates->exists = 0;
  for (int i = 0; i < kNumRegions; ++i) {
    samples->best_cost[i] = 1e30f;
    samples->count[i] = visit.pattern.num_base[i];
    samples->best[i] =
        BestSample(visit, i, 0, samples->count[i], &samples->best_cost[i]);
    if (samples->best[i] >= 0) candidates->exists |= 1u << i;
  }
  candidates->exists = CheapestRegions(
      samples->best_cost, candidates->exists, visit.params.max_candidates);
}

// Second step: the planes of these pixels, and which of them differ enough to
// be evaluated.
HPM_HD void FindDifferent(const PixelVisit& visit,
                          RegionSamples* samples,
                          Candidates* candidates,
                          CandidateBatch* batch) {
  const VisitParams& params = visit.params;
  const float x = static_cast<float>(visit.col);
  const float y = static_cast<float>(visit.row);
  const PlaneSlope current = SlopeOf(params.ref, visit.state.planes[visit.at]);
  CandidateSlopes slopes = {};
  batch->size = 0;
  uint32_t different = 0;  // candidates with a row of costs of their own
  for (int i = 0; i < kNumRegions; ++i) {
    if (!(candidates->exists >> i & 1)) continue;
    candidates->plane[i] = visit.state.planes[samples->best[i]];
    const PlaneSlope slope = SlopeOf(params.ref, candidates->plane[i]);
    slopes.col[i] = slope.col;
    slopes.row[i] = slope.row;
    slopes.constant[i] = slope.constant;
    const uint32_t same = NearlySame(params, slopes, slope, x, y) & different;
    samples->same_as[i] = same != 0 ? LowestBit(same) : i;
    if (samples->same_as[i] != i) continue;
    different |= 1u << i;
    batch->Add(i, candidates->plane[i]);
  }
  candidates->current =
      NearlySame(params, slopes, current, x, y) & candidates->exists;
}

// The rows of the matrix that belong to the batch; costs[b * num_views + k] is
// that of its plane b in view[k].
HPM_HD void TakeCosts(const CandidateBatch& batch,
                      const float* costs,
                      Candidates* candidates) {
  const int num_views = candidates->num_views;
  for (int b = 0; b < batch.size; ++b) {
    for (int j = 0; j < num_views; ++j) {
      candidates->matrix[batch.region[b] * num_views + j] =
          costs[b * num_views + j];
    }
  }
}

// The rows of candidates that share the costs of another one.
HPM_HD void CopySharedCosts(const RegionSamples& samples,
                            Candidates* candidates) {
  const int num_views = candidates->num_views;
  for (int i = 0; i < kNumRegions; ++i) {
    if (!(candidates->exists >> i & 1) || samples.same_as[i] == i) continue;
    for (int j = 0; j < num_views; ++j) {
      candidates->matrix[i * num_views + j] =
          candidates->matrix[samples.same_as[i] * num_views + j];
    }
  }
}

// Third step: regions whose candidate does not convince double; a better pixel
// in the new part takes the place of the candidate. `growing`: the regions that
// have not stopped yet.
HPM_HD void ExtendRegions(const PixelVisit& visit,
                          float tau,
                          uint32_t* growing,
                          RegionSamples* samples,
                          Candidates* candidates,
                          CandidateBatch* batch) {
  const int num_views = candidates->num_views;
  batch->size = 0;
  for (int i = 0; i < kNumRegions; ++i) {
    if (!(*growing >> i & 1)) continue;
    if (!MustExtend(&candidates->matrix[i * num_views], num_views, tau)) {
      *growing &= ~(1u << i);
      continue;
    }
    const int count = samples->count[i];
    const int best =
        BestSample(visit, i, count, 2 * count, &samples->best_cost[i]);
    samples->count[i] *= 2;
    if (best < 0) continue;
    candidates->plane[i] = visit.state.planes[best];
    candidates->current &= ~(1u << i);
    batch->Add(i, candidates->plane[i]);
  }
}

// A search for candidates between two batches of costs.
struct CandidateSearch {
  RegionSamples samples;
  CandidateBatch batch;  // to be evaluated now, in candidates->view
  uint32_t growing;
  int extension;
};

// `draw`: random, in [0, 1).
HPM_HD void BeginSearch(const PixelVisit& visit,
                        float draw,
                        CandidateSearch* search,
                        Candidates* candidates) {
  ChooseViews(visit, draw, candidates);
  SampleRegions(visit, &search->samples, candidates);
  FindDifferent(visit, &search->samples, candidates, &search->batch);
  search->growing = candidates->exists;
  search->extension = 0;
}

// Takes the costs of the batch; returns whether there is another one, which
// may be empty.
HPM_HD bool ContinueSearch(const PixelVisit& visit,
                           const float* costs,
                           CandidateSearch* search,
                           Candidates* candidates) {
  TakeCosts(search->batch, costs, candidates);
  if (search->extension == 0) CopySharedCosts(search->samples, candidates);
  if (search->extension == visit.pattern.max_extensions) return false;
  ExtendRegions(visit,
                Tau(visit.iteration, search->extension++),
                &search->growing,
                &search->samples,
                candidates,
                &search->batch);
  return search->growing != 0;
}

// `draw`: as above.
template <class Cost>
HPM_HD void CollectCandidates(const PixelVisit& visit,
                              const Cost& cost,
                              float draw,
                              Candidates* candidates) {
  CandidateSearch search;
  BeginSearch(visit, draw, &search, candidates);
  float costs[kNumRegions * kMaxViews];
  do {
    if (search.batch.size > 0) {
      cost.Photometric(search.batch.plane,
                       search.batch.size,
                       candidates->view,
                       candidates->num_views,
                       costs);
    }
  } while (ContinueSearch(visit, costs, &search, candidates));
}

}  // namespace hpm
