#include "src/core/consistency_filter.h"

#include "tests/core/fake_cost.h"
#include "tests/core/test_cameras.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr float kDegree = 3.14159265f / 180;

// A wall at depth 1 on the axis of the reference; every view is 10 degrees to
// the side and matches perfectly. Each test spoils one thing for view 1.
class ConsistencyFilter : public testing::Test {
 protected:
  ConsistencyFilter() {
    params_.ref = MakeTestCamera(100, 80, 100, 0, {0, 0, 0});
    params_.ref.cx = 50;
    params_.ref.cy = 40;
    params_.num_views = 3;
    for (Vec3f& center : centers_) center = AtAngle(10);
    for (float& cost : costs_) cost = 0.1f;
    for (float& error : errors_) error = 0.2f;
  }

  // Sees the point (0, 0, 1) under this angle against the reference.
  static Vec3f AtAngle(float degrees) {
    return {2 * std::sin(degrees * kDegree),
            0,
            1 - 2 * std::cos(degrees * kDegree)};
  }

  uint32_t Mask() const {
    const FakeCost cost = {
        [this](const Plane&, int view) { return costs_[view]; },
        [this](const Plane&, int view) { return errors_[view]; },
        without_depth_};
    return ConsistentViews(params_, filter_, centers_, cost, plane_, 50, 40);
  }

  VisitParams params_ = {};
  FilterParams filter_ = {0.1f, 3 * kDegree, 1.0f, 2};
  Plane plane_ = {{0, 0, -1}, 1};
  Vec3f centers_[3];
  float costs_[3];
  float errors_[3];
  uint32_t without_depth_ = 0;
};

TEST_F(ConsistencyFilter, KeepsGoodViews) { EXPECT_EQ(Mask(), 7u); }

TEST_F(ConsistencyFilter, DropsLowNcc) {
  costs_[1] = 0.91f;
  EXPECT_EQ(Mask(), 5u);
  costs_[1] = 0.89f;
  EXPECT_EQ(Mask(), 7u);
}

TEST_F(ConsistencyFilter, DropsSmallTriangulationAngles) {
  centers_[1] = AtAngle(2.9f);
  EXPECT_EQ(Mask(), 5u);
  centers_[1] = AtAngle(3.1f);
  EXPECT_EQ(Mask(), 7u);
  centers_[1] = AtAngle(-3.1f);
  EXPECT_EQ(Mask(), 7u);
  filter_.min_triangulation_angle = 3.2f * kDegree;
  EXPECT_EQ(Mask(), 5u);
  filter_.min_triangulation_angle = 0;
  centers_[1] = AtAngle(0.5f);
  EXPECT_EQ(Mask(), 7u);
}

TEST_F(ConsistencyFilter, DropsViewsWithoutDepthInGeometricPasses) {
  without_depth_ = 1u << 1;
  EXPECT_EQ(Mask(), 7u);
  params_.geometric = true;
  EXPECT_EQ(Mask(), 5u);
}

TEST_F(ConsistencyFilter, DropsViewsThatSeeTheBack) {
  centers_[1] = {0.5f, 0, 2};
  EXPECT_EQ(Mask(), 5u);
  plane_.normal = Normalized({0.9f, 0, -0.1f});
  plane_.distance = -plane_.normal.z;
  EXPECT_EQ(Mask() & 1u, 1u);
  centers_[0] = AtAngle(-10);
  EXPECT_EQ(Mask() & 1u, 0u);
}

TEST_F(ConsistencyFilter, DropsReprojectionErrorsInGeometricPassesOnly) {
  errors_[1] = 1.1f;
  EXPECT_EQ(Mask(), 7u);
  params_.geometric = true;
  EXPECT_EQ(Mask(), 5u);
  errors_[1] = 0.9f;
  EXPECT_EQ(Mask(), 7u);
}

TEST_F(ConsistencyFilter, KeepsNothingWithoutAPlaneInFrontOfTheCamera) {
  plane_ = {{0, 0, 0}, 0};
  EXPECT_EQ(Mask(), 0u);
}

TEST_F(ConsistencyFilter, BitsNameTheViewAlsoBehindDroppedOnes) {
  centers_[0] = AtAngle(1);
  costs_[1] = 1.5f;
  EXPECT_EQ(Mask(), 4u);
}

}  // namespace
}  // namespace hpm
