#include "src/core/candidates.h"

#include "src/core/sampling_pattern.h"
#include "tests/core/fake_cost.h"
#include "tests/core/test_cameras.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

bool Extends(const std::vector<float>& costs, int iteration, int extension) {
  return MustExtend(
      costs.data(), static_cast<int>(costs.size()), Tau(iteration, extension));
}

// Paper, section 3.2: tau = 0.8 exp(-iteration^2 (3 - extension) / 90).
TEST(MustExtend, ThresholdTightensWithIterationsAndLoosensWithExtensions) {
  const float expected[3][3] = {{0.8f, 0.8f, 0.8f},
                                {0.7738f, 0.7824f, 0.7912f},
                                {0.7001f, 0.7319f, 0.7652f}};
  for (int t = 0; t < 3; ++t) {
    for (int e = 0; e < 3; ++e) {
      EXPECT_FALSE(Extends({1.0f, expected[t][e] - 1e-3f}, t, e));
      EXPECT_TRUE(Extends({1.0f, expected[t][e] + 1e-3f}, t, e));
    }
  }
}

TEST(MustExtend, OneConvincedViewIsEnough) {
  EXPECT_FALSE(Extends({0.1f, 1.0f, 1.0f, 1.0f}, 0, 0));
  EXPECT_TRUE(Extends({1.0f, 1.0f, 1.0f, 1.0f}, 0, 0));
}

TEST(MustExtend, MoreThanTwoBadViewsAreTooMany) {
  EXPECT_FALSE(Extends({0.1f, 0.1f, 1.3f, 1.3f}, 0, 0));
  EXPECT_TRUE(Extends({0.1f, 1.3f, 1.3f, 1.3f}, 0, 0));
  EXPECT_FALSE(Extends({0.1f, 1.2f, 1.2f, 1.2f}, 0, 0));
}

// The bound is meant for cameras that see the surface from about the same
// distance; the shift of a sample may then exceed it by a factor of two.
TEST(NearlySame, BoundsTheShiftOfThePatchInTheSourceView) {
  constexpr float kBound = 0.05f;
  Random random(8);
  int num_same = 0, num_different = 0;
  for (int i = 0; i < 3000; ++i) {
    const Camera ref = MakeTestCamera(200, 150, 180, 0, {0, 0, 0});
    const Camera src = MakeTestCamera(200,
                                      150,
                                      200,
                                      UniformIn(&random, -3, 3),
                                      {UniformIn(&random, -0.7, 0.7),
                                       UniformIn(&random, -0.7, 0.7),
                                       UniformIn(&random, -0.3, 0.3)});
    VisitParams params = {};
    params.ref = ref;
    params.patch_radius = 5;
    params.same_plane_bound = kBound;
    params.parallax = 1.1f * 200 * Norm(Center(src));
    const Vec3f normal = RandomFacingNormal(&random);
    // Mostly small, so that both sides of the bound are met.
    const auto cube = [&](double scale) {
      const double u = UniformIn(&random, -1, 1);
      return static_cast<float>(scale * u * u * u);
    };
    const float slip = cube(0.01);
    const float tilt = cube(0.5);
    const Plane a = PlaneFromDepth(ref, 100, 75, 5, normal);
    const Plane b =
        PlaneFromDepth(ref,
                       100,
                       75,
                       5 * (1 + slip),
                       Normalized({normal.x + tilt, normal.y, normal.z}));
    float shift = 0;
    for (const int dcol : {-5, 0, 5}) {
      for (const int drow : {-5, 0, 5}) {
        const auto in_src = [&](const Plane& plane) {
          return ProjectInto(
              src, InWorld(ref, PointOn(ref, plane, 100 + dcol, 75 + drow)));
        };
        const Eigen::Vector3d moved = in_src(a) - in_src(b);
        shift = std::fmax(shift,
                          static_cast<float>(std::hypot(moved.x(), moved.y())));
      }
    }
    // In a row of others that are far away.
    const int place = i % kNumRegions;
    CandidateSlopes slopes;
    for (int j = 0; j < kNumRegions; ++j) {
      const PlaneSlope slope =
          SlopeOf(ref, j == place ? a : Plane{{0, 0, -1}, 1});
      slopes.col[j] = slope.col;
      slopes.row[j] = slope.row;
      slopes.constant[j] = slope.constant;
    }
    const uint32_t same = NearlySame(params, slopes, SlopeOf(ref, b), 100, 75);
    EXPECT_EQ(same & ~(1u << place), 0u);
    if (same != 0) {
      ++num_same;
      EXPECT_LT(shift, 2 * kBound);
    } else {
      ++num_different;
      EXPECT_GT(shift, 0);
    }
  }
  EXPECT_GT(num_same, 100);
  EXPECT_GT(num_different, 100);
}

TEST(MostVoted, KeepsTheViewsOfMostVotes) {
  const uint32_t votes[kMaxViews] = {3, 1, 4, 0, 2};
  EXPECT_EQ(MostVoted(0b11111, votes, 5, 2, 0), 0b00101u);
  EXPECT_EQ(MostVoted(0b11011, votes, 5, 2, 3), 0b10001u);
  EXPECT_EQ(MostVoted(0b01010, votes, 5, 2, 0), 0b01010u);
  EXPECT_EQ(MostVoted(0b00100, votes, 5, 2, 0), 0b00100u);
}

TEST(MostVoted, AmongEqualsTheTurnDecides) {
  const uint32_t votes[kMaxViews] = {};
  EXPECT_EQ(MostVoted(0b111, votes, 3, 1, 0), 0b100u);
  EXPECT_EQ(MostVoted(0b111, votes, 3, 1, 1), 0b001u);
  EXPECT_EQ(MostVoted(0b111, votes, 3, 1, 2), 0b010u);
}

constexpr int kSide = 201;
constexpr int kMiddle = 100;

// A field of pixels whose planes carry their index as distance.
class CollectCandidatesTest : public testing::Test {
 protected:
  CollectCandidatesTest()
      : planes_(kSide * kSide),
        costs_(kSide * kSide, 1),
        masks_(kSide * kSide, 0b11) {
    for (int i = 0; i < kSide * kSide; ++i) {
      planes_[i] = {{0, 0, -1}, static_cast<float>(i)};
    }
    params_.num_views = 2;
    params_.max_candidates = kNumRegions;
  }

  static int Index(int col, int row) { return row * kSide + col; }

  Candidates Collect(bool extensible,
                     const FakeCost& cost,
                     int col = kMiddle,
                     int row = kMiddle) {
    const PixelState state = {
        kSide, kSide, planes_.data(), costs_.data(), masks_.data(), nullptr};
    Candidates candidates;
    const SamplingPattern pattern = MakeSamplingPattern(true, extensible);
    CollectCandidates(VisitOf(params_, pattern, state, 0, col, row),
                      cost,
                      draw_,
                      &candidates);
    return candidates;
  }

  bool Proposes(const Candidates& candidates, int col, int row) const {
    for (int i = 0; i < kNumRegions; ++i) {
      if ((candidates.exists >> i & 1) &&
          candidates.plane[i].distance == static_cast<float>(Index(col, row))) {
        return true;
      }
    }
    return false;
  }

  VisitParams params_ = {};
  std::vector<Plane> planes_;
  std::vector<float> costs_;
  mutable std::vector<uint32_t> masks_;
  float draw_ = 0;
  const FakeCost convincing_ = {[](const Plane&, int) { return 0.1f; }};
  const FakeCost doubtful_ = {[](const Plane&, int) { return 1.0f; }};
};

// Also to the right, where the public code takes the worst.
TEST_F(CollectCandidatesTest, TakesTheSmallestStoredCostOfEachRegion) {
  const int best[8][2] = {
      {0, -9}, {0, 11}, {-7, 0}, {13, 0}, {-9, -8}, {8, -9}, {13, 12}, {-6, 5}};
  for (const auto& [dcol, drow] : best) {
    costs_[Index(kMiddle + dcol, kMiddle + drow)] = 0.2f;
  }
  const Candidates candidates = Collect(false, convincing_);
  EXPECT_EQ(candidates.exists, 0xFFu);
  for (const auto& [dcol, drow] : best) {
    EXPECT_TRUE(Proposes(candidates, kMiddle + dcol, kMiddle + drow))
        << dcol << ", " << drow;
  }
}

TEST_F(CollectCandidatesTest, MatrixHoldsTheCostOfEachCandidateInEachView) {
  const FakeCost cost = {[](const Plane& plane, int view) {
    return std::fmod(plane.distance, 97.0f) / 100 +
           static_cast<float>(view) / 200;
  }};
  const Candidates candidates = Collect(false, cost);
  for (int i = 0; i < kNumRegions; ++i) {
    for (int j = 0; j < 2; ++j) {
      EXPECT_EQ(candidates.matrix[i * 2 + j],
                cost.photometric(candidates.plane[i], j));
    }
  }
}

// The views that two trust and one in turn, or the most voted of the pixel's
// own.
TEST_F(CollectCandidatesTest, AsksTheViewsThatAreTrusted) {
  params_.num_views = 6;
  params_.max_views = 2;
  masks_[Index(kMiddle, kMiddle)] = 0b000111;
  const int dcol[4] = {0, 0, -5, 5}, drow[4] = {-5, 5, 0, 0};
  const uint32_t around[4] = {0b001101, 0b001100, 0b001010, 0b000000};
  for (int b = 0; b < 4; ++b)
    masks_[Index(kMiddle + dcol[b], kMiddle + drow[b])] = around[b];
  draw_ = 0.99f;  // the turn of view 5
  const auto asked = [&] {
    const Candidates candidates = Collect(false, convincing_);
    uint32_t views = 0;
    for (int k = 0; k < candidates.num_views; ++k)
      views |= 1u << candidates.view[k];
    return views;
  };
  EXPECT_EQ(asked(), 0b101111u);
  params_.few_views = true;
  // Votes 1, 1 and 2; from the turn on the first of fewest goes.
  EXPECT_EQ(asked(), 0b000110u);
  masks_[Index(kMiddle, kMiddle)] = 0;
  EXPECT_EQ(asked(), 0b100000u);
}

TEST_F(CollectCandidatesTest, LooksIntoTheRegionsOfSmallestCostOnly) {
  params_.max_candidates = 3;
  for (const int k : {1, 2, 3}) {
    costs_[Index(kMiddle, kMiddle - 5 - 2 * k)] = 0.3f + 0.1f * k;  // up
    costs_[Index(kMiddle + 5 + 2 * k, kMiddle)] = 0.4f + 0.1f * k;  // right
    costs_[Index(kMiddle - 5 - 2 * k, kMiddle)] = 0.5f + 0.1f * k;  // left
    costs_[Index(kMiddle, kMiddle + 5 + 2 * k)] = 0.6f + 0.1f * k;  // down
  }
  convincing_.num_evaluations = 0;
  const Candidates candidates = Collect(false, convincing_);
  EXPECT_EQ(__builtin_popcount(candidates.exists), 3);
  EXPECT_TRUE(Proposes(candidates, kMiddle, kMiddle - 7));
  EXPECT_TRUE(Proposes(candidates, kMiddle + 7, kMiddle));
  EXPECT_TRUE(Proposes(candidates, kMiddle - 7, kMiddle));
  EXPECT_EQ(convincing_.num_evaluations, 3 * candidates.num_views);
}

TEST_F(CollectCandidatesTest, RegionsOutsideTheImageDoNotExist) {
  // At the corner only those to the right, below, and right-below are inside.
  const Candidates corner = Collect(true, convincing_, 0, 0);
  EXPECT_EQ(__builtin_popcount(corner.exists), 3);
  EXPECT_TRUE(Proposes(corner, 5, 0));
  EXPECT_TRUE(Proposes(corner, 0, 5));
  EXPECT_TRUE(Proposes(corner, 5, 6));
}

TEST_F(CollectCandidatesTest, ConvincingRegionsDoNotGrow) {
  costs_[Index(kMiddle, kMiddle - 15)] = 0.01f;
  EXPECT_FALSE(Proposes(Collect(true, convincing_), kMiddle, kMiddle - 15));
  EXPECT_EQ(convincing_.num_evaluations, 8 * 2);
}

// All eight regions; in the public code only the first can.
TEST_F(CollectCandidatesTest, EveryDoubtfulRegionGrowsThreeTimes) {
  const int furthest[8][2] = {{0, -83},
                              {0, 83},
                              {-83, 0},
                              {83, 0},
                              {-69, -68},
                              {68, -69},
                              {69, 68},
                              {-68, 69}};
  for (const auto& [dcol, drow] : furthest) {
    costs_[Index(kMiddle + dcol, kMiddle + drow)] = 0.01f;
  }
  const Candidates grown = Collect(true, doubtful_);
  const Candidates fixed = Collect(false, doubtful_);
  for (const auto& [dcol, drow] : furthest) {
    EXPECT_TRUE(Proposes(grown, kMiddle + dcol, kMiddle + drow))
        << dcol << ", " << drow;
    EXPECT_FALSE(Proposes(fixed, kMiddle + dcol, kMiddle + drow));
  }
}

TEST_F(CollectCandidatesTest, GrowthStopsAtTheFirstConvincingSample) {
  costs_[Index(kMiddle, kMiddle - 15)] = 0.5f;   // reached by doubling once
  costs_[Index(kMiddle, kMiddle - 25)] = 0.01f;  // by doubling twice
  const float near_one = planes_[Index(kMiddle, kMiddle - 15)].distance;
  const FakeCost cost = {[=](const Plane& plane, int) {
    return plane.distance == near_one ? 0.1f : 1.0f;
  }};
  const Candidates candidates = Collect(true, cost);
  EXPECT_TRUE(Proposes(candidates, kMiddle, kMiddle - 15));
  EXPECT_FALSE(Proposes(candidates, kMiddle, kMiddle - 25));
}

TEST_F(CollectCandidatesTest, NearlyEqualCandidatesShareOneRowOfCosts) {
  params_.ref = MakeTestCamera(kSide, kSide, 200, 0, {0, 0, 0});
  params_.patch_radius = 5;
  params_.parallax = 100;
  params_.same_plane_bound = 0.05f;
  for (Plane& plane : planes_) plane = {{0, 0, -1}, 5};
  planes_[Index(kMiddle, kMiddle - 5)].distance = 6;
  costs_[Index(kMiddle, kMiddle - 5)] = 0.5f;
  const FakeCost cost = {[](const Plane& plane, int) {
    return plane.distance == 6 ? 0.2f : 0.1f;
  }};
  const Candidates candidates = Collect(true, cost);
  EXPECT_EQ(cost.num_evaluations, 2 * 2);  // two planes, two views
  EXPECT_EQ(__builtin_popcount(candidates.current), kNumRegions - 1);
  for (int i = 0; i < kNumRegions; ++i) {
    for (int j = 0; j < 2; ++j) {
      EXPECT_EQ(candidates.matrix[i * 2 + j],
                cost.photometric(candidates.plane[i], j));
    }
  }
}

// Views that hardly a neighbour trusts cost time, and with them come the
// occlusions.
TEST_F(CollectCandidatesTest, AsksTrustedViewsAndOneMoreInTurn) {
  params_.num_views = 8;
  masks_.assign(masks_.size(), 0b10000000);
  masks_[Index(kMiddle, kMiddle)] = 0b10;
  const int d = MakeSamplingPattern(true, false).mask_distance;
  masks_[Index(kMiddle - d, kMiddle)] = 0b1100;
  masks_[Index(kMiddle + d, kMiddle)] = 0b100;
  const FakeCost cost = {
      [](const Plane&, int view) { return 0.01f * static_cast<float>(view); }};
  for (const int turn : {0, 5}) {
    draw_ = (static_cast<float>(turn) + 0.5f) / 8;
    const Candidates candidates = Collect(false, cost);
    std::vector<int> views(candidates.view,
                           candidates.view + candidates.num_views);
    std::vector<int> expected = {1, 2, 7, turn};
    std::sort(expected.begin(), expected.end());
    EXPECT_EQ(views, expected);
    for (int k = 0; k < candidates.num_views; ++k) {
      // Two neighbours trust views 2 and 7, one view 3; the pixel has no vote.
      const float votes = views[k] == 7 || views[k] == 2 ? 2.0f : 0.4f;
      EXPECT_FLOAT_EQ(candidates.votes[k], votes) << views[k];
    }
    for (int k = 0; k < candidates.num_views; ++k) {
      EXPECT_EQ(candidates.matrix[3 * candidates.num_views + k],
                0.01f * static_cast<float>(views[k]));
    }
  }
}

TEST_F(CollectCandidatesTest, AWorseSampleFurtherOutReplacesNothing) {
  costs_[Index(kMiddle, kMiddle - 7)] = 0.5f;
  costs_[Index(kMiddle, kMiddle - 17)] = 0.6f;
  EXPECT_TRUE(Proposes(Collect(true, doubtful_), kMiddle, kMiddle - 7));
}

}  // namespace
}  // namespace hpm
