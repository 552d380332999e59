#include "src/core/match_cost.h"

#include "tests/core/test_cameras.h"

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

using GreyFunction = std::function<float(float u, float v)>;

float Pattern(float u, float v) {
  return 128 + 60 * std::sin(0.5f * u + 0.2f * v) +
         40 * std::cos(0.3f * v - 0.1f * u);
}

PatchShape DefaultShape() { return MakePatchShape(5, 5, 3, 15); }

RefPatch PatchOf(const PatchShape& shape,
                 const GreyFunction& grey,
                 int col,
                 int row) {
  return MakeRefPatch(
      shape,
      [&](int c, int r) {
        return grey(static_cast<float>(c), static_cast<float>(r));
      },
      [&](bool mixed, float d) { return ColorWeight(shape, mixed, d); },
      col,
      row);
}

PatchWarp Shift(float u, float v) { return {{u, v, 1}, {1, 0, 0}, {0, 1, 0}}; }

// Cost at (30, 20) of the plane that maps the patch onto itself.
float CostInPlace(const GreyFunction& ref, const GreyFunction& src) {
  const PatchShape shape = DefaultShape();
  return MatchCost(
      shape, PatchOf(shape, ref, 30, 20), Shift(30, 20), src, kWidth, kHeight);
}

TEST(MatchCost, WindowOfRadiusFiveHas36SamplesTwoPixelsApart) {
  const PatchShape shape = DefaultShape();
  const int expected[] = {-5, -3, -1, 1, 3, 5};
  for (int i = 0; i < kPatchAxis; ++i) EXPECT_EQ(shape.offset[i], expected[i]);
  EXPECT_FLOAT_EQ(shape.spatial[0], std::exp(-std::sqrt(50.0f) / 50));
  EXPECT_FLOAT_EQ(shape.spatial[2 * 6 + 3], std::exp(-std::sqrt(2.0f) / 50));
  EXPECT_FLOAT_EQ(shape.color_falloff, 1.0f / 18);
}

// The weight of the first sample that differs by 30, beside that of a sample
// like the centre at the same distance.
double WeightOfUnlike(int num_like) {
  const PatchShape shape = DefaultShape();
  const auto grey = [&](float u, float v) {
    if (u == 30 && v == 20) return 100.0f;
    const int i = static_cast<int>(u - 25) / 2,
              j = static_cast<int>(v - 15) / 2;
    return kPatchAxis * j + i < num_like ? 100.0f : 130.0f;
  };
  const RefPatch patch = PatchOf(shape, grey, 30, 20);
  return patch.weight[kPatchSize - 1] / patch.weight[0];
}

TEST(MatchCost, WindowsMixedAllOverKeepMoreOfWhatIsUnlikeTheirCentre) {
  const double tail = std::exp(-30.0 / 18);
  EXPECT_NEAR(WeightOfUnlike(12), tail * std::exp(-0.5 * 2 * 2), 1e-5);
  EXPECT_NEAR(WeightOfUnlike(35), tail * std::exp(-0.5 * 2 * 2), 1e-5);
  const double off = 30 / 18.75;
  EXPECT_NEAR(WeightOfUnlike(11), tail * std::exp(-0.5 * off * off), 1e-5);
}

TEST(MatchCost, WhatAMaskHidesMakesNoWindowMixed) {
  PatchShape shape = DefaultShape();
  shape.ref_has_gaps = true;
  // The mask hides all but two rows, one of which is like the centre.
  const auto grey = [](float, float v) {
    return v >= 25 ? 130.0f : (v == 20 || v == 23 ? 100.0f : 0.0f);
  };
  const RefPatch patch = PatchOf(shape, grey, 30, 20);
  EXPECT_EQ(patch.weight[0], 0);
  const int unlike = kPatchSize - 1;
  const double weight =
      shape.spatial[unlike] * std::exp(-30.0 / 18 - 0.5 * 2 * 2);
  const int like = unlike - kPatchAxis;
  EXPECT_NEAR(patch.weight[unlike] / patch.weight[like],
              weight / shape.spatial[like],
              1e-5);
}

TEST(MatchCost, WithoutACutThePapersWeightsHoldInAllWindows) {
  const PatchShape shape = MakePatchShape(5, 5, 3, 0);
  for (const bool mixed : {false, true})
    EXPECT_FLOAT_EQ(ColorWeight(shape, mixed, 36), std::exp(-2.0f));
}

TEST(MatchCost, WindowReachesItsRadiusAndIsSymmetric) {
  for (int radius = 1; radius <= 20; ++radius) {
    const PatchShape shape = MakePatchShape(radius, 5, 3, 15);
    EXPECT_EQ(shape.offset[0], -radius);
    EXPECT_EQ(shape.offset[kPatchAxis - 1], radius);
    for (int i = 0; i < kPatchAxis; ++i) {
      // Half-way values are rounded up, so a mirrored offset may be one off.
      EXPECT_NEAR(shape.offset[i], -shape.offset[kPatchAxis - 1 - i], 1);
      if (i > 0) {
        EXPECT_GE(shape.offset[i], shape.offset[i - 1]);
      }
    }
  }
}

TEST(MatchCost, PatchHoldsWeightsMeanAndVarianceOfItsDefinition) {
  const PatchShape shape = DefaultShape();
  const RefPatch patch = PatchOf(shape, Pattern, 30, 20);
  double sum = 0, mean = 0, square = 0;
  std::vector<double> weights;
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const double x = shape.offset[i], y = shape.offset[j];
      const double grey =
          Pattern(30 + static_cast<float>(x), 20 + static_cast<float>(y));
      // A mixed window.
      const double w = std::exp(
          -std::hypot(x, y) / 50 - std::abs(grey - Pattern(30, 20)) / 18 -
          std::pow((grey - Pattern(30, 20)) / 18.75, 2) / 2);
      weights.push_back(w);
      sum += w;
      mean += w * grey;
      square += w * grey * grey;
    }
  }
  mean /= sum;
  for (int k = 0; k < kPatchSize; ++k) {
    EXPECT_NEAR(patch.weight[k], weights[k] / sum, 1e-6);
  }
  EXPECT_NEAR(patch.center + patch.mean, mean, 1e-3);
  EXPECT_NEAR(
      patch.variance, square / sum - mean * mean, 1e-3 * patch.variance);
}

TEST(MatchCost, IdenticalPatchesCostNothing) {
  EXPECT_NEAR(CostInPlace(Pattern, Pattern), 0, 1e-5);
}

TEST(MatchCost, AffineChangeOfBrightnessCostsNothing) {
  EXPECT_NEAR(
      CostInPlace(Pattern,
                  [](float u, float v) { return 0.3f * Pattern(u, v) + 40; }),
      0,
      1e-5);
}

TEST(MatchCost, InvertedPatchCostsTwo) {
  EXPECT_NEAR(CostInPlace(Pattern,
                          [](float u, float v) { return 255 - Pattern(u, v); }),
              2,
              1e-5);
}

TEST(MatchCost, ConstantReferenceOrSourceCostsTwo) {
  const auto constant = [](float, float) { return 77.0f; };
  EXPECT_EQ(CostInPlace(constant, Pattern), kMaxCost);
  EXPECT_EQ(CostInPlace(Pattern, constant), kMaxCost);
  EXPECT_EQ(CostInPlace(constant, constant), kMaxCost);
}

// One grey level of difference in a bright image still matches.
TEST(MatchCost, FaintTextureOnABrightWallIsSeenExactly) {
  const auto faint = [](float u, float v) {
    return 250 + std::round(0.5f + 0.4f * std::sin(2 * u + 3 * v));
  };
  EXPECT_NEAR(CostInPlace(faint, faint), 0, 1e-4);
}

TEST(MatchCost, NoiseCostsAboutOneAndStaysInRange) {
  std::mt19937 random(1);
  double sum = 0;
  constexpr int kTrials = 300;
  for (int trial = 0; trial < kTrials; ++trial) {
    std::vector<float> a(kWidth * kHeight), b(kWidth * kHeight);
    for (float& v : a) v = static_cast<float>(100 + random() % 20);
    for (float& v : b) v = static_cast<float>(random() % 256);
    const auto look_up = [](const std::vector<float>& image) {
      return [&image](float u, float v) {
        return image[static_cast<size_t>(v) * kWidth + static_cast<size_t>(u)];
      };
    };
    const float cost = CostInPlace(look_up(a), look_up(b));
    ASSERT_GE(cost, 0);
    ASSERT_LE(cost, kMaxCost);
    sum += cost;
  }
  EXPECT_NEAR(sum / kTrials, 1, 0.06);
}

TEST(MatchCost, AgreesWithTheTextbookFormula) {
  const PatchShape shape = DefaultShape();
  const RefPatch ref = PatchOf(shape, Pattern, 30, 20);
  const auto other = [](float u, float v) {
    return Pattern(u, v) + 30 * std::sin(0.8f * u - 0.5f * v);
  };
  double sw = 0, sr = 0, ss = 0, srr = 0, sss = 0, srs = 0;
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const float x = static_cast<float>(30 + shape.offset[i]);
      const float y = static_cast<float>(20 + shape.offset[j]);
      const double w = ref.weight[j * kPatchAxis + i];
      const double r = Pattern(x, y), s = other(x + 2.5f, y - 1.25f);
      sw += w, sr += w * r, ss += w * s;
      srr += w * r * r, sss += w * s * s, srs += w * r * s;
    }
  }
  const double cov = srs / sw - sr * ss / sw / sw;
  const double var_r = srr / sw - sr * sr / sw / sw;
  const double var_s = sss / sw - ss * ss / sw / sw;
  EXPECT_NEAR(
      MatchCost(shape, ref, Shift(32.5f, 18.75f), other, kWidth, kHeight),
      1 - cov / std::sqrt(var_r * var_s),
      1e-4);
}

TEST(MatchCost, NothingMatchesWhereTheSourceShowsNothing) {
  const PatchShape shape = DefaultShape();
  const RefPatch ref = PatchOf(shape, Pattern, 30, 20);
  // All that is left of column 29.5 is a gap.
  const auto sample = [](float u, float v) {
    return u < 29.5f ? 0.0f : Pattern(u, v);
  };
  const auto cost = [&](float u, bool has_gaps) {
    return MatchCost(
        shape, ref, Shift(u, 20), sample, kWidth, kHeight, has_gaps);
  };
  EXPECT_EQ(cost(29.4f, true), kMaxCost);
  EXPECT_LT(cost(29.4f, false), kMaxCost);
  EXPECT_LT(cost(29.6f, true), kMaxCost);
  EXPECT_EQ(cost(29.6f, true), cost(29.6f, false));
}

TEST(MatchCost, ReferencePixelsThatShowNothingDoNotCount) {
  PatchShape shape = DefaultShape();
  shape.ref_has_gaps = true;
  // Dark, so that black would count like the rest.
  const auto dark = [](float u, float v) { return 6 + Pattern(u, v) / 50; };
  // All that is left of column 29.5 is a gap.
  const auto with_gap = [&](float u, float v) {
    return u < 29.5f ? 0.0f : dark(u, v);
  };
  const RefPatch ref = PatchOf(shape, with_gap, 30, 20);
  float sum = 0;
  for (int k = 0; k < kPatchSize; ++k) {
    if (shape.offset[k % kPatchAxis] < 0) {
      EXPECT_EQ(ref.weight[k], 0);
    }
    sum += ref.weight[k];
  }
  EXPECT_NEAR(sum, 1, 1e-5);
  // Whatever the source shows there.
  const auto cost = [&](const RefPatch& patch, float u) {
    return MatchCost(shape, patch, Shift(u, 20), dark, kWidth, kHeight);
  };
  EXPECT_LT(cost(ref, 30), 1e-3);
  // Nothing matches a gap itself.
  EXPECT_EQ(cost(PatchOf(shape, with_gap, 27, 20), 27), kMaxCost);
  // Without gaps black is a value like others.
  shape.ref_has_gaps = false;
  const RefPatch black = PatchOf(shape, with_gap, 30, 20);
  EXPECT_GT(black.weight[0], 0);
  EXPECT_GT(cost(black, 30), 1e-2);
  EXPECT_LT(cost(PatchOf(shape, with_gap, 27, 20), 27), kMaxCost);
}

TEST(MatchCost, CentreOutsideTheSourceImageCostsTwo) {
  const PatchShape shape = DefaultShape();
  const RefPatch ref = PatchOf(shape, Pattern, 30, 20);
  const auto cost_at = [&](float u, float v) {
    return MatchCost(shape, ref, Shift(u, v), Pattern, kWidth, kHeight);
  };
  for (const float inside : {-0.49f, 0.0f, 63.0f, 63.49f}) {
    EXPECT_LT(cost_at(inside, 20), kMaxCost) << inside;
  }
  for (const float outside : {-0.51f, -100.0f, 63.51f, 1e9f}) {
    EXPECT_EQ(cost_at(outside, 20), kMaxCost) << outside;
  }
  EXPECT_LT(cost_at(30, 47.49f), kMaxCost);
  EXPECT_EQ(cost_at(30, 47.51f), kMaxCost);
  EXPECT_EQ(cost_at(30, -0.51f), kMaxCost);
}

TEST(MatchCost, PatchBehindOrPartlyBehindTheSourceCameraCostsTwo) {
  const PatchShape shape = DefaultShape();
  const RefPatch ref = PatchOf(shape, Pattern, 30, 20);
  const auto cost_of = [&](const PatchWarp& warp) {
    return MatchCost(shape, ref, warp, Pattern, kWidth, kHeight);
  };
  // The same position as (30, 20), seen from behind: a mirrored projection.
  EXPECT_EQ(cost_of({{-30, -20, -1}, {-1, 0, 0}, {0, -1, 0}}), kMaxCost);
  EXPECT_EQ(cost_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), kMaxCost);
  // The centre is in front, the corner of the window behind.
  EXPECT_EQ(cost_of({{30, 20, 1}, {1, 0, 0.15f}, {0, 1, 0.06f}}), kMaxCost);
  EXPECT_LT(cost_of({{30, 20, 1}, {1, 0, 0.01f}, {0, 1, 0.01f}}), kMaxCost);
}

TEST(MatchCost, HypothesesWithoutAPlaneCostTwo) {
  const PatchShape shape = DefaultShape();
  const RefPatch ref = PatchOf(shape, Pattern, 30, 20);
  const Camera a = MakeTestCamera(kWidth, kHeight, 60, 0, {0, 0, 0});
  const Camera b = MakeTestCamera(kWidth, kHeight, 60, 0, {0.2, 0, 0});
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  for (const Plane& plane : {Plane{{nan, 0, -1}, 1},
                             Plane{{0, 0, -1}, nan},
                             Plane{{0, 0, 0}, 0},
                             Plane{{inf, 0, -1}, 1}}) {
    const PatchWarp warp =
        WarpPatch(MakeViewWarp(a, b), SlopeOf(a, plane), 30, 20);
    EXPECT_EQ(MatchCost(shape, ref, warp, Pattern, kWidth, kHeight), kMaxCost);
  }
}

}  // namespace
}  // namespace hpm
