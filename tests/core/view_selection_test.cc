#include "src/core/view_selection.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr uint32_t kAll = 0xFF;

// Likelihood of the only view.
float Likelihood(const std::vector<float>& costs,
                 uint32_t exists = kAll,
                 float good_cost = 0.8f) {
  return ViewLikelihood(costs.data(), 1, 0, exists, good_cost);
}

const float kUndecided = std::exp(-0.64f / 0.32f);  // good cost 0.8

TEST(GoodCost, TightensWithTheIterations) {
  EXPECT_FLOAT_EQ(GoodCost(0), 0.8f);
  EXPECT_FLOAT_EQ(GoodCost(1), 0.8f * std::exp(-1.0f / 90));
  EXPECT_FLOAT_EQ(GoodCost(2), 0.8f * std::exp(-4.0f / 90));
}

TEST(ViewLikelihood, MoreThanTwoGoodCostsGiveTheirMeanLikelihood) {
  EXPECT_FLOAT_EQ(Likelihood({0.1f, 0.2f, 0.3f, 0.9f, 0.9f, 0.9f, 0.9f, 0.9f}),
                  (std::exp(-0.01f / 0.18f) + std::exp(-0.04f / 0.18f) +
                   std::exp(-0.09f / 0.18f)) /
                      3);
}

TEST(ViewLikelihood, TwoGoodCostsAreNotEnough) {
  EXPECT_FLOAT_EQ(Likelihood({0.1f, 0.2f, 0.9f, 0.9f, 0.9f, 0.9f, 0.9f, 0.9f}),
                  kUndecided);
}

TEST(ViewLikelihood, ThreeBadCostsRuleAViewOut) {
  EXPECT_EQ(Likelihood({0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 1.3f, 1.3f, 1.3f}), 0);
  EXPECT_GT(Likelihood({0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 0.1f, 1.3f, 1.3f}), 0);
}

TEST(ViewLikelihood, CostsAtTheThresholdsAreNeitherGoodNorBad) {
  EXPECT_FLOAT_EQ(Likelihood({0.8f, 0.8f, 0.8f, 1.2f, 1.2f, 1.2f, 1.2f, 1.2f}),
                  kUndecided);
}

// The public code counts missing regions as perfect matches.
TEST(ViewLikelihood, MissingCandidatesDoNotVote) {
  EXPECT_FLOAT_EQ(Likelihood({0, 0, 0, 0, 0.1f, 0.1f, 0.1f, 0.9f}, 0xF0),
                  std::exp(-0.01f / 0.18f));
  EXPECT_FLOAT_EQ(Likelihood({2, 2, 2, 2, 0.1f, 0.1f, 0.1f, 0.9f}, 0xF0),
                  std::exp(-0.01f / 0.18f));
  EXPECT_FLOAT_EQ(Likelihood({0, 0, 0, 0, 0, 0, 0, 0}, 0), kUndecided);
}

TEST(ViewLikelihood, ReadsTheColumnOfItsView) {
  std::vector<float> costs(8 * 3, 2.0f);
  for (int i = 0; i < 8; ++i) costs[i * 3 + 1] = 0;
  EXPECT_EQ(ViewLikelihood(costs.data(), 3, 0, kAll, 0.8f), 0);
  EXPECT_EQ(ViewLikelihood(costs.data(), 3, 1, kAll, 0.8f), 1);
}

// Draws of each view, 0 where it was not drawn.
std::vector<float> Draws(const std::vector<float>& probability,
                         int num_draws,
                         float offset) {
  uint8_t views[kMaxViews];
  for (size_t j = 0; j < probability.size(); ++j)
    views[j] = static_cast<uint8_t>(j);
  const ViewWeights weights = DrawViews(probability.data(),
                                        views,
                                        static_cast<int>(probability.size()),
                                        num_draws,
                                        offset);
  std::vector<float> draws(probability.size(), 0);
  float sum = 0;
  uint32_t mask = 0;
  for (int k = 0; k < weights.num_views; ++k) {
    EXPECT_GT(weights.weight[k], 0);
    draws[weights.view[k]] = weights.weight[k];
    sum += weights.weight[k];
    mask |= 1u << weights.view[k];
  }
  EXPECT_EQ(sum, weights.weight_sum);
  EXPECT_EQ(mask, weights.mask);
  return draws;
}

TEST(DrawViews, NamesTheViewsItWasGiven) {
  const float probability[3] = {0.5f, 0, 0.5f};
  const uint8_t views[3] = {4, 9, 17};
  const ViewWeights weights = DrawViews(probability, views, 3, 10, 0.5f);
  ASSERT_EQ(weights.num_views, 2);
  EXPECT_EQ(weights.view[0], 4);
  EXPECT_EQ(weights.view[1], 17);
  EXPECT_EQ(weights.slot[1], 2);
  EXPECT_EQ(weights.mask, 1u << 4 | 1u << 17);
}

TEST(KeepLargest, ZeroesAllButTheLargest) {
  float p[5] = {0.3f, 0.1f, 0, 0.4f, 0.2f};
  KeepLargest(2, 5, p);
  EXPECT_EQ(std::vector<float>(p, p + 5),
            (std::vector<float>{0.3f, 0, 0, 0.4f, 0}));
}

TEST(KeepLargest, LeavesFewerAlone) {
  float p[3] = {0.3f, 0, 0.4f};
  KeepLargest(2, 3, p);
  EXPECT_EQ(std::vector<float>(p, p + 3), (std::vector<float>{0.3f, 0, 0.4f}));
}

const std::vector<float> kProbability = {0.2f, 0, 1.3f, 0.05f, 0.45f, 0, 2.0f};

TEST(DrawViews, NumberOfDrawsIsTheExpectationRoundedUpOrDown) {
  for (float offset = 0; offset < 1; offset += 0.01f) {
    const std::vector<float> draws = Draws(kProbability, 15, offset);
    float sum = 0;
    for (size_t j = 0; j < draws.size(); ++j) {
      const float expected = kProbability[j] / 4 * 15;
      EXPECT_LT(std::abs(draws[j] - expected), 1) << j;
      sum += draws[j];
    }
    EXPECT_EQ(sum, 15);
  }
}

TEST(DrawViews, MeanOverOffsetsIsTheProbability) {
  constexpr int kOffsets = 4096;
  std::vector<double> mean(kProbability.size(), 0);
  for (int i = 0; i < kOffsets; ++i) {
    const auto draws =
        Draws(kProbability, 15, (static_cast<float>(i) + 0.5f) / kOffsets);
    for (size_t j = 0; j < draws.size(); ++j) mean[j] += draws[j] / kOffsets;
  }
  for (size_t j = 0; j < mean.size(); ++j) {
    EXPECT_NEAR(mean[j], 15 * kProbability[j] / 4, 2e-3);
  }
}

TEST(DrawViews, ViewsWithoutProbabilityAreNeverDrawn) {
  for (const float offset : {0.0f, 0.3f, 0.99f, 0.99999994f}) {
    const auto draws = Draws(kProbability, 15, offset);
    EXPECT_EQ(draws[1], 0);
    EXPECT_EQ(draws[5], 0);
    EXPECT_EQ(Draws({0, 0, 3.0f}, 15, offset)[0], 0);
  }
}

TEST(DrawViews, AllViewsCountAlikeIfNoneHasAProbability) {
  EXPECT_EQ(Draws({0, 0, 0}, 15, 0.5f), (std::vector<float>{1, 1, 1}));
}

TEST(DrawViews, SomethingIsAlwaysDrawn) {
  for (const int num_draws : {1, 2, 15, 100}) {
    for (const float offset : {0.0f, 0.5f, 0.99999994f}) {
      for (const int num_views : {1, 2, kMaxViews}) {
        const auto draws =
            Draws(std::vector<float>(num_views, 1e-30f), num_draws, offset);
        EXPECT_GT(*std::max_element(draws.begin(), draws.end()), 0);
      }
    }
  }
}

}  // namespace
}  // namespace hpm
