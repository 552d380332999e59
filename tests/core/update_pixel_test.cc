#include "src/core/update_pixel.h"

#include "src/core/sampling_pattern.h"
#include "tests/core/fake_cost.h"
#include "tests/core/test_cameras.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kSide = 41;
constexpr int kMiddle = 20;
constexpr float kTrueDepth = 4;

// Cost grows with the distance from a fronto-parallel wall at kTrueDepth, in
// every view alike.
float WallCost(const Plane& plane, int) {
  const float depth_error = std::abs(plane.distance / kTrueDepth - 1);
  return std::fmin(2.0f, 4 * depth_error + 1 + plane.normal.z);
}

class UpdatePixelTest : public testing::Test {
 protected:
  UpdatePixelTest()
      : planes_(kSide * kSide, Plane{{0, 0, -1}, 3}),
        costs_(kSide * kSide, 1.0f),
        masks_(kSide * kSide, 0b111),
        priors_(kSide * kSide, Plane{{0, 0, 0}, 0}) {
    params_.ref = MakeTestCamera(kSide, kSide, 1000, 0, {0, 0, 0});
    params_.num_views = 3;
    params_.depth_min = 2;
    params_.depth_max = 6;
    params_.num_view_draws = 15;
    params_.max_views = 32;
    params_.max_candidates = kNumRegions;
    params_.depth_perturbation = 0.02f;
    params_.normal_perturbation = 0.0314f;
    params_.worst_cost = kMaxCost;
    params_.geometric_term = {0.1f, 5};
    params_.prior_term = {0.5f, 0.18f, 4.0f / 64, 0.087f};
  }

  PixelState View(bool with_priors = false) {
    return {kSide,
            kSide,
            planes_.data(),
            costs_.data(),
            masks_.data(),
            with_priors ? priors_.data() : nullptr};
  }

  void Visit(const FakeCost& cost, uint64_t key = 1, bool with_priors = false) {
    Rng rng(key, kMiddle, kMiddle);
    const PixelState state = View(with_priors);
    UpdatePixel(
        VisitOf(params_, pattern_, state, 0, kMiddle, kMiddle), cost, &rng);
  }

  Plane& Here() { return planes_[kMiddle * kSide + kMiddle]; }
  float CostHere() const { return costs_[kMiddle * kSide + kMiddle]; }
  uint32_t MaskHere() const { return masks_[kMiddle * kSide + kMiddle]; }
  void SetAt(int dcol, int drow, const Plane& plane, float cost) {
    planes_[(kMiddle + drow) * kSide + kMiddle + dcol] = plane;
    costs_[(kMiddle + drow) * kSide + kMiddle + dcol] = cost;
  }

  VisitParams params_ = {};
  SamplingPattern pattern_ = MakeSamplingPattern(true, true);
  std::vector<Plane> planes_;
  std::vector<float> costs_;
  std::vector<uint32_t> masks_;
  std::vector<Plane> priors_;
  const FakeCost wall_ = {WallCost};
};

TEST_F(UpdatePixelTest, TakesABetterPlaneFromAfar) {
  SetAt(9, 0, {{0, 0, -1}, kTrueDepth}, 0.05f);
  Visit(wall_);
  EXPECT_LT(CostHere(), 1e-3);
  EXPECT_NEAR(Here().distance, kTrueDepth, 1e-3);
  EXPECT_NE(MaskHere(), 0u);
}

TEST_F(UpdatePixelTest, StoredCostIsThatOfTheStoredPlane) {
  for (uint64_t key = 0; key < 50; ++key) {
    Visit(wall_, key);
    EXPECT_FLOAT_EQ(CostHere(), WallCost(Here(), 0));
  }
}

TEST_F(UpdatePixelTest, RepeatedVisitsNeverGetWorseAndConverge) {
  float before = WallCost(Here(), 0);
  for (uint64_t key = 0; key < 500; ++key) {
    Visit(wall_, key);
    ASSERT_LE(CostHere(), before);
    before = CostHere();
  }
  EXPECT_LT(before, 0.02);
}

TEST_F(UpdatePixelTest, HypothesesOutsideTheDepthRangeAreNotTaken) {
  SetAt(9, 0, {{0, 0, -1}, kTrueDepth}, 0.05f);
  params_.depth_max = 3.9f;
  for (uint64_t key = 0; key < 100; ++key) {
    Visit(wall_, key);
    ASSERT_LE(DepthAt(params_.ref, Here(), kMiddle, kMiddle), 3.9f + 1e-4f);
  }
}

TEST_F(UpdatePixelTest, MaskFollowsPropagationOnly) {
  masks_[kMiddle * kSide + kMiddle] = 0x4;
  // Every neighbour holds the pixel's own plane: only refinement can improve.
  for (uint64_t key = 0; key < 20; ++key) Visit(wall_, key);
  EXPECT_LT(CostHere(), 1);
  EXPECT_EQ(MaskHere(), 0x4u);
}

TEST_F(UpdatePixelTest, ViewsThatDisagreeWithAllCandidatesAreNotUsed) {
  SetAt(9, 0, {{0, 0, -1}, kTrueDepth}, 0.05f);
  const FakeCost occluded = {[](const Plane& plane, int view) {
    return view == 1 ? 1.9f : WallCost(plane, view);
  }};
  planes_.assign(planes_.size(), Plane{{0, 0, -1}, kTrueDepth});
  Here().distance = 3;
  Visit(occluded);
  EXPECT_EQ(MaskHere(), 0b101u);
  EXPECT_LT(CostHere(), 1e-3);
}

// Read by pixels that may be visited at the same time.
TEST_F(UpdatePixelTest, ReadsOnlyTheOtherColour) {
  for (const bool non_local : {false, true}) {
    pattern_ = MakeSamplingPattern(non_local, true);
    const float nan = std::numeric_limits<float>::quiet_NaN();
    for (int row = 0; row < kSide; ++row) {
      for (int col = 0; col < kSide; ++col) {
        const int at = row * kSide + col;
        if ((col + row) % 2 == 0 && at != kMiddle * kSide + kMiddle) {
          planes_[at] = {{nan, nan, nan}, nan};
          costs_[at] = -1;  // would win every comparison
          masks_[at] = 0xFFFFFFFF;
        }
      }
    }
    Visit(wall_);
    EXPECT_LE(CostHere(), 1);
    EXPECT_TRUE(std::isfinite(Here().distance));
  }
}

TEST_F(UpdatePixelTest, GeometricTermDecidesBetweenEqualCosts) {
  params_.geometric = true;
  SetAt(9, 0, {{0, 0, -1}, kTrueDepth}, 0.05f);
  const FakeCost cost = {
      [](const Plane&, int) { return 0.5f; },
      [&](const Plane& plane, int) {
        const float depth = DepthAt(params_.ref, plane, kMiddle, kMiddle);
        return std::fmin(5.0f, 20 * std::abs(depth - kTrueDepth));
      }};
  Visit(cost);
  EXPECT_NEAR(CostHere(), 0.5f, 0.01f);
  EXPECT_NEAR(Here().distance, kTrueDepth, 0.01);
}

TEST_F(UpdatePixelTest, SearchingNearTriesNothingFarButThePrior) {
  const Plane prior = {{0, 0, -1}, 5};
  priors_.assign(priors_.size(), prior);
  int num_far[2] = {};
  for (const bool near : {false, true}) {
    params_.search_near = near;
    for (const bool with_priors : {false, true}) {
      int num_priors = 0;
      const FakeCost cost = {[&](const Plane& plane, int) {
        const float depth = DepthAt(params_.ref, plane, kMiddle, kMiddle);
        if (depth == prior.distance && plane.normal.z == prior.normal.z) {
          ++num_priors;
        } else if (std::abs(depth / 3 - 1) > 1.01f * params_.depth_perturbation)
          ++num_far[near];
        return 1.0f;
      }};
      Here() = {{0, 0, -1}, 3};
      Visit(cost, 1, with_priors);
      EXPECT_EQ(num_priors > 0, with_priors);
    }
  }
  EXPECT_GT(num_far[false], 0);
  EXPECT_EQ(num_far[true], 0);
}

// Where nothing can be seen nothing must break: weights of no view are 0 / 0.
TEST_F(UpdatePixelTest, PixelThatNoViewSeesStaysFinite) {
  const FakeCost blind = {[](const Plane&, int) { return kMaxCost; }};
  for (uint64_t key = 0; key < 20; ++key) {
    Visit(blind, key);
    EXPECT_EQ(CostHere(), kMaxCost);
    EXPECT_EQ(Here().distance, 3);
  }
}

// Two of three views look past a near surface; a far one, wrong, is in the
// frame of all and resembles what they show a little.
TEST_F(UpdatePixelTest, ViewsThatDoNotSeeASurfaceDoNotSpeakAgainstIt) {
  const Plane near = {{0, 0, -1}, 2.5f};
  const FakeCost seen_by_one = {[&](const Plane& plane, int view) {
    if (plane.distance != near.distance) return 0.8f;
    return view == 0 ? 0.2f : kMaxCost;
  }};
  SetAt(9, 0, near, 0.2f);
  int taken[2] = {};
  for (const bool capped : {false, true}) {
    params_.worst_cost = capped ? 1 : kMaxCost;
    for (uint64_t key = 0; key < 20; ++key) {
      Here() = {{0, 0, -1}, 3};
      Visit(seen_by_one, key);
      taken[capped] += Here().distance == near.distance;
    }
  }
  EXPECT_EQ(taken[0], 0);
  EXPECT_EQ(taken[1], 20);
}

// The public code replaces a good plane at every pixel with a prior by one of
// the refinements.
TEST_F(UpdatePixelTest, ConvergedPlaneOnItsPriorIsLeftAlone) {
  const Plane truth = {{0, 0, -1}, kTrueDepth};
  Here() = truth;
  priors_.assign(priors_.size(), truth);
  for (uint64_t key = 0; key < 100; ++key) {
    Visit(wall_, key, true);
    ASSERT_EQ(Here().distance, kTrueDepth);
    ASSERT_EQ(Here().normal.z, -1);
  }
}

TEST_F(UpdatePixelTest, PriorDecidesWhereCostsAreEqual) {
  priors_.assign(priors_.size(), Plane{{0, 0, -1}, 5});
  SetAt(9, 0, {{0, 0, -1}, 5}, 0.05f);
  const FakeCost flat = {[](const Plane&, int) { return 0.6f; }};
  Visit(flat, 1, true);
  EXPECT_NEAR(Here().distance, 5, 0.1);
}

}  // namespace
}  // namespace hpm
