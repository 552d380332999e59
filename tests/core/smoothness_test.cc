#include "src/core/smoothness.h"

#include "tests/core/fake_cost.h"
#include "tests/core/test_cameras.h"

#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kSide = 21;
constexpr int kMiddle = 10;

class SmoothnessTest : public testing::Test {
 protected:
  SmoothnessTest() : planes_(kSide * kSide, kTilted) {
    params_.ref = MakeTestCamera(kSide, kSide, 100, 0, {0, 0, 0});
    params_.parallax = 50;
    params_.smoothness = {0.4f, 1, 10};
  }

  float CostOf(const Plane& plane) const {
    const PixelState state = {kSide,
                              kSide,
                              const_cast<Plane*>(planes_.data()),
                              nullptr,
                              nullptr,
                              nullptr};
    Surroundings around;
    CollectSurroundings(params_, state, cost_, kMiddle, kMiddle, &around);
    return SmoothnessCost(params_, around, plane);
  }

  // Tilted about the point of the middle pixel.
  Plane ThroughMiddle(const Vec3f& normal) const {
    return PlaneFromDepth(params_.ref,
                          kMiddle,
                          kMiddle,
                          DepthAt(params_.ref, kTilted, kMiddle, kMiddle),
                          Normalized(normal));
  }

  inline static const Plane kTilted = {Normalized({0.2f, 0.1f, -1}), 2};
  VisitParams params_ = {};
  std::vector<Plane> planes_;
  FakeCost cost_ = {[](const Plane&, int) { return 0.0f; }};
};

TEST_F(SmoothnessTest, ThePlaneOfTheNeighboursCostsNothing) {
  EXPECT_NEAR(CostOf(kTilted), 0, 1e-5);
}

TEST_F(SmoothnessTest, AWrongNormalCostsEvenWhereTheDepthIsRight) {
  const float little = CostOf(ThroughMiddle({0.1f, 0.1f, -1}));
  const float much = CostOf(ThroughMiddle({-0.2f, 0.1f, -1}));
  EXPECT_GT(little, 0.01);
  EXPECT_GT(much, 1.5f * little);
}

TEST_F(SmoothnessTest, IsBoundedByItsWeight) {
  EXPECT_LE(CostOf({{0, 0, -1}, 0.5f}), 0.4f + 1e-6f);
  EXPECT_GT(CostOf({{0, 0, -1}, 0.5f}), 0.39f);
}

TEST_F(SmoothnessTest, NeighboursOfAnotherGreyValueHaveNoSay) {
  cost_.grey = [](int col, int) { return col < kMiddle ? 0.0f : 200.0f; };
  // What lies left of the edge is nearer; it must not pull.
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kMiddle; ++col)
      planes_[row * kSide + col] = {{0, 0, -1}, 0.5f};
  }
  EXPECT_NEAR(CostOf(kTilted), 0, 1e-5);
}

TEST_F(SmoothnessTest, WeightZeroSwitchesItOff) {
  params_.smoothness.weight = 0;
  EXPECT_EQ(CostOf({{0, 0, -1}, 0.5f}), 0);
}

}  // namespace
}  // namespace hpm
