// Joint view selection of ACMH (Xu and Tao 2019), which the paper takes over
// (section 3.2): the costs of all candidates vote for the views worth trusting.
#pragma once

#include "src/core/host_device.h"
#include "src/core/limits.h"

#include <math.h>
#include <stdint.h>

namespace hpm {

// Views drawn for one pixel and their weights (number of draws).
struct ViewWeights {
  int num_views;
  uint8_t view[kMaxViews];
  uint8_t slot[kMaxViews];  // where DrawViews() found the view
  float weight[kMaxViews];
  float weight_sum;
  uint32_t mask;
};

// Bit j: view j, for all of them.
HPM_HD uint32_t AllViews(int num_views) {
  return (1u << (num_views - 1)) * 2u - 1u;
}

// A cost below it speaks for a view; tightens with the iterations.
HPM_HD float GoodCost(int iteration) {
  return 0.8f * expf(-static_cast<float>(iteration * iteration) / 90.0f);
}

constexpr float kBadCost = 1.2f;

// Likelihood of a view from the costs of the candidates that exist.
// costs[i * num_views + view]; exists: bit i = candidate i.
HPM_HD float ViewLikelihood(const float* costs,
                            int num_views,
                            int view,
                            uint32_t exists,
                            float good_cost) {
  int num_good = 0, num_bad = 0;
  float sum = 0;
  for (int i = 0; i < kNumRegions; ++i) {
    if (!(exists >> i & 1)) continue;
    const float cost = costs[i * num_views + view];
    if (cost < good_cost) {
      ++num_good;
      sum += expf(-cost * cost / 0.18f);
    } else if (cost > kBadCost) {
      ++num_bad;
    }
  }
  if (num_bad >= 3) return 0;
  if (num_good > 2) return sum / static_cast<float>(num_good);
  return expf(-good_cost * good_cost / 0.32f);
}

// Sets all but the `count` largest probabilities to zero.
HPM_HD void KeepLargest(int count, int num_views, float* probability) {
  for (int drop = num_views - count; drop > 0; --drop) {
    int least = -1;
    for (int j = 0; j < num_views; ++j) {
      if (probability[j] > 0 &&
          (least < 0 || probability[j] < probability[least]))
        least = j;
    }
    if (least < 0) return;
    int num_positive = 0;
    for (int j = 0; j < num_views; ++j) num_positive += probability[j] > 0;
    if (num_positive <= count) return;
    probability[least] = 0;
  }
}

// Draws `num_draws` views in proportion to `probability` (not normalised) by
// systematic sampling: one random offset in [0, 1) for all draws, which has the
// expectation of independent draws and less noise. If no view has a
// probability, all views count alike.
HPM_HD ViewWeights DrawViews(const float* probability,
                             const uint8_t* views,
                             int num_views,
                             int num_draws,
                             float offset) {
  float total = 0;
  for (int j = 0; j < num_views; ++j) total += probability[j];
  ViewWeights weights;
  weights.num_views = 0;
  weights.mask = 0;
  weights.weight_sum = 0;
  float cumulated = 0;
  int drawn = 0;
  for (int j = 0; j < num_views; ++j) {
    float count = 1;
    if (total > 0) {
      cumulated += probability[j];
      int until = static_cast<int>(
          ceilf(cumulated / total * static_cast<float>(num_draws) - offset));
      if (until > num_draws) until = num_draws;
      count = static_cast<float>(until > drawn ? until - drawn : 0);
      if (until > drawn) drawn = until;
    }
    if (count > 0) {
      weights.view[weights.num_views] = views[j];
      weights.slot[weights.num_views] = static_cast<uint8_t>(j);
      weights.weight[weights.num_views++] = count;
      weights.weight_sum += count;
      weights.mask |= 1u << views[j];
    }
  }
  return weights;
}

}  // namespace hpm
