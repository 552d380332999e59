#include "src/prior/region_planes.h"

#include "tests/prior/prior_scene.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr float kTolerance = 1e-3f;  // 1/z
constexpr PriorRange kRange = {0.5f, 50};

class RegionPlanesTest : public testing::Test {
 protected:
  // One region over the whole image; reliable inverse depths from `plane`
  // where `reliable(col, row)`.
  RegionPlanesTest()
      : camera_(PriorCamera(kWidth, kHeight)),
        regions_{
            kWidth, kHeight, 1, std::vector<uint16_t>(kWidth * kHeight, 1)} {}

  template <class Reliable>
  void Support(const Plane& plane, const Reliable& reliable) {
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) {
        if (!reliable(col, row)) continue;
        points_.push_back({col,
                           row,
                           1 / DepthAt(camera_,
                                       plane,
                                       static_cast<float>(col),
                                       static_cast<float>(row))});
      }
    }
  }

  std::vector<Plane> Make(uint64_t key = 1) const {
    return MakeRegionPlanes(
        regions_, camera_, points_, kTolerance, kRange, key);
  }

  void ExpectPlane(const std::vector<Plane>& planes,
                   const Plane& truth,
                   int col,
                   int row) const {
    const Plane& plane = planes[row * kWidth + col];
    ASSERT_GT(plane.distance, 0) << col << " " << row;
    EXPECT_NEAR(DepthDifference(camera_, plane, truth, col, row), 0, 2e-3);
    EXPECT_GT(Dot(plane.normal, truth.normal), 0.999);
    EXPECT_NEAR(Norm(plane.normal), 1, 1e-5);
  }

  Camera camera_;
  WeakRegions regions_;
  std::vector<ReliablePoint> points_;
};

TEST_F(RegionPlanesTest, ReachFromOneCornerOverTheWholeRegion) {
  Support(TiltedPlane(), [](int col, int row) { return col < 40 && row < 40; });
  const std::vector<Plane> planes = Make();
  ExpectPlane(planes, TiltedPlane(), 5, 5);
  ExpectPlane(planes, TiltedPlane(), kWidth - 1, kHeight - 1);
}

TEST_F(RegionPlanesTest, AFifthOfFalsePointsDoesNotBendThePlane) {
  Support(TiltedPlane(), [](int, int) { return true; });
  for (size_t i = 0; i < points_.size(); i += 5)
    points_[i].inverse_depth *= 1.05f + 0.3f * static_cast<float>(i % 7);
  ExpectPlane(Make(), TiltedPlane(), 80, 60);
}

TEST_F(RegionPlanesTest, TwoWallsInOneRegionKeepTheirSides) {
  const Plane other = {Normalized({-0.5f, 0.1f, -1.0f}), 3.0f};
  Support(TiltedPlane(), [](int col, int) { return col < 80; });
  Support(other, [](int col, int) { return col >= 80; });
  const std::vector<Plane> planes = Make();
  ExpectPlane(planes, TiltedPlane(), 20, 60);
  ExpectPlane(planes, other, 140, 60);
}

TEST_F(RegionPlanesTest, RegionsDoNotShareTheirPlanes) {
  for (int i = 0; i < kWidth * kHeight; ++i)
    if (i % kWidth >= 80) regions_.label[i] = 2;
  regions_.num_regions = 2;
  Support(TiltedPlane(), [](int col, int) { return col < 80; });
  const std::vector<Plane> planes = Make();
  ExpectPlane(planes, TiltedPlane(), 40, 60);
  EXPECT_EQ(planes[60 * kWidth + 120].distance, 0);
}

TEST_F(RegionPlanesTest, TooLittleOrScatteredSupportGivesNoPlane) {
  EXPECT_EQ(Make()[0].distance, 0);
  Support(TiltedPlane(), [](int col, int row) { return col < 6 && row < 6; });
  EXPECT_EQ(Make()[0].distance, 0);
  // No twelfth of these lies on one plane.
  Support(TiltedPlane(), [](int, int) { return true; });
  for (size_t i = 0; i < points_.size(); ++i) {
    points_[i].inverse_depth =
        0.1f + 0.9f * std::fmod(0.618034f * static_cast<float>(i), 1.0f);
  }
  EXPECT_EQ(Make()[0].distance, 0);
}

TEST_F(RegionPlanesTest, PixelsOnOneLineGiveNoPlane) {
  Support(TiltedPlane(), [](int, int row) { return row == 60; });
  EXPECT_EQ(Make()[0].distance, 0);
}

TEST_F(RegionPlanesTest, PlanesThatLeaveTheRangeAreDroppedThere) {
  Support(TiltedPlane(), [](int, int) { return true; });
  const float z = DepthAt(camera_, TiltedPlane(), 80, 60);
  const std::vector<Plane> planes =
      MakeRegionPlanes(regions_, camera_, points_, kTolerance, {0.5f, z}, 1);
  int num_inside = 0;
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const Plane& plane = planes[row * kWidth + col];
      num_inside += plane.distance > 0;
      if (plane.distance > 0) {
        EXPECT_LE(DepthAt(camera_,
                          plane,
                          static_cast<float>(col),
                          static_cast<float>(row)),
                  z);
      }
    }
  }
  EXPECT_GT(num_inside, 1000);
  EXPECT_LT(num_inside, kWidth * kHeight - 1000);
}

TEST_F(RegionPlanesTest, SameKeySamePlanes) {
  Support(TiltedPlane(), [](int, int) { return true; });
  const std::vector<Plane> a = Make(7), b = Make(7);
  for (size_t i = 0; i < a.size(); ++i) {
    ASSERT_EQ(a[i].distance, b[i].distance);
    ASSERT_EQ(a[i].normal.x, b[i].normal.x);
  }
}

}  // namespace
}  // namespace hpm
