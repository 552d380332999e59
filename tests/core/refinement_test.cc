#include "src/core/refinement.h"

#include "tests/core/test_cameras.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

const Vec3f kOblique = {0.6f, -0.4f, 1};

float AngleOf(const Vec3f& a, const Vec3f& b) {
  return std::atan2(Norm(Cross(a, b)), Dot(a, b));
}

TEST(RandomNormal, IsUnitAndFacesTheCamera) {
  Rng rng(1, 0, 0);
  for (int i = 0; i < 10000; ++i) {
    const Vec3f n = RandomNormal(kOblique, &rng);
    ASSERT_NEAR(Norm(n), 1, 1e-6);
    ASSERT_LE(Dot(n, kOblique), 0);
  }
}

// On a uniform hemisphere the height above its base is uniform in [0, 1].
TEST(RandomNormal, IsUniformOnTheHemisphere) {
  constexpr int kCount = 100000;
  const Vec3f axis = Normalized(kOblique);
  const Vec3f side = Normalized(Cross(axis, {0, 1, 0}));
  Rng rng(2, 0, 0);
  int deciles[10] = {};
  double sideways = 0;
  for (int i = 0; i < kCount; ++i) {
    const Vec3f n = RandomNormal(kOblique, &rng);
    ++deciles[std::min(9, static_cast<int>(-10 * Dot(n, axis)))];
    sideways += Dot(n, side);
  }
  for (const int count : deciles) {
    EXPECT_NEAR(count, kCount / 10, 5 * std::sqrt(0.09 * kCount));
  }
  EXPECT_NEAR(sideways / kCount, 0, 5 / std::sqrt(3.0 * kCount));
}

TEST(PerturbNormal, TurnsByAtMostThreeTimesTheAngle) {
  constexpr float kAngle = 0.03f;
  const Vec3f n = Normalized({0.3f, 0.2f, -1});
  Rng rng(3, 0, 0);
  float largest = 0;
  double sum_x = 0, sum_y = 0;
  constexpr int kCount = 20000;
  for (int i = 0; i < kCount; ++i) {
    const Vec3f p = PerturbNormal(n, kOblique, kAngle, &rng);
    ASSERT_NEAR(Norm(p), 1, 1e-6);
    ASSERT_LT(Dot(p, kOblique), 0);
    largest = std::max(largest, AngleOf(n, p));
    sum_x += p.x - n.x;
    sum_y += p.y - n.y;
  }
  // Rotations about three axes; sqrt(3) if they were one, a little more as not.
  EXPECT_LE(largest, 1.02f * std::sqrt(3.0f) * kAngle);
  EXPECT_GE(largest, kAngle);
  EXPECT_NEAR(sum_x / kCount, 0, 0.03 * kAngle);
  EXPECT_NEAR(sum_y / kCount, 0, 0.03 * kAngle);
}

TEST(PerturbNormal, NoAngleChangesNothing) {
  const Vec3f n = Normalized({0.3f, 0.2f, -1});
  Rng rng(4, 0, 0);
  EXPECT_LT(Norm(PerturbNormal(n, kOblique, 0, &rng) - n), 1e-6);
}

TEST(PerturbNormal, KeepsANormalThatWouldTurnAway) {
  const Vec3f ray = {0, 0, 1};
  const Vec3f grazing = Normalized({1, 0, -0.001f});
  Rng rng(5, 0, 0);
  int num_kept = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3f p = PerturbNormal(grazing, ray, 0.1f, &rng);
    ASSERT_LT(Dot(p, ray), 0);
    num_kept += Norm(p - grazing) == 0;
  }
  EXPECT_GT(num_kept, 300);
  EXPECT_LT(num_kept, 700);
}

// The paper's seven hypotheses (section 3.2) without the current one.
TEST(CombineHypotheses, GivesTheSixCombinations) {
  const Camera camera = MakeTestCamera(100, 80, 90, 0.3, {0, 0, 0});
  const Vec3f n = Normalized({0.1f, 0, -1});
  const Vec3f n_random = Normalized({-0.5f, 0.3f, -1});
  const Vec3f n_perturbed = Normalized({0.12f, 0.01f, -1});
  const Vec3f ray = RayAt(camera, 30, 50);
  Plane planes[kNumRefined];
  CombineHypotheses(ray, 5, n, 8, n_random, planes);
  CombineHypotheses(ray, 5, n, 5.1f, n_perturbed, planes + kNumCombined);
  const float depths[] = {8, 5, 8, 5.1f, 5, 5.1f};
  const Vec3f* normals[] = {
      &n, &n_random, &n_random, &n, &n_perturbed, &n_perturbed};
  for (int i = 0; i < kNumRefined; ++i) {
    EXPECT_NEAR(DepthAt(camera, planes[i], 30, 50), depths[i], 1e-5) << i;
    EXPECT_EQ(Norm(planes[i].normal - *normals[i]), 0) << i;
  }
}

}  // namespace
}  // namespace hpm
