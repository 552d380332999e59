#include "src/prior/region_planes.h"

#include "tests/prior/prior_scene.h"

#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr float kTolerance = 1e-3f;  // 1/z

class RegionPlanesTest : public testing::Test {
 protected:
  // One region over the whole image but a frame of kRimWidth pixels.
  RegionPlanesTest()
      : camera_(PriorCamera(kWidth, kHeight)),
        regions_{
            kWidth, kHeight, 1, std::vector<uint16_t>(kWidth * kHeight, 0)} {
    for (int row = kRimWidth; row < kHeight - kRimWidth; ++row) {
      for (int col = kRimWidth; col < kWidth - kRimWidth; ++col)
        regions_.label[row * kWidth + col] = 1;
    }
  }

  // Reliable points of `plane` inside and on the rim, where
  // `reliable(col, row)`.
  template <class Reliable>
  void Support(const Plane& plane, const Reliable& reliable) {
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) {
        if (!reliable(col, row)) continue;
        const float z = DepthAt(
            camera_, plane, static_cast<float>(col), static_cast<float>(row));
        (IsInside(col, row) ? inner_ : rim_).push_back({col, row, 1 / z});
      }
    }
  }
  bool IsInside(int col, int row) const { return regions_.At(col, row) > 0; }

  std::vector<RegionPlane> Find(int label = 1, uint64_t key = 1) const {
    return FindRegionPlanes(regions_, camera_, inner_, rim_, 1, kTolerance, key)
        .of_region[label];
  }

  void ExpectPlane(const RegionPlane& found, const Plane& truth) const {
    for (const auto& [col, row] : {std::pair(5, 5), {150, 110}}) {
      EXPECT_NEAR(
          DepthDifference(camera_, found.plane, truth, col, row), 0, 2e-3);
    }
    EXPECT_GT(Dot(found.plane.normal, truth.normal), 0.999);
    EXPECT_NEAR(Norm(found.plane.normal), 1, 1e-5);
  }

  Camera camera_;
  WeakRegions regions_;
  std::vector<ReliablePoint> inner_, rim_;
};

const auto kEverywhere = [](int, int) { return true; };

TEST_F(RegionPlanesTest, ReachFromOneCornerOverTheWholeRegion) {
  Support(TiltedPlane(), [](int col, int row) { return col < 70 && row < 70; });
  for (const RegionPlane& found : Find()) ExpectPlane(found, TiltedPlane());
  EXPECT_FALSE(Find().empty());
}

TEST_F(RegionPlanesTest, AFifthOfFalsePointsDoesNotBendThePlane) {
  Support(TiltedPlane(), kEverywhere);
  for (size_t i = 0; i < inner_.size(); i += 5)
    inner_[i].inverse_depth *= 1.05f + 0.3f * static_cast<float>(i % 7);
  ExpectPlane(Find().at(0), TiltedPlane());
  EXPECT_NEAR(Find()[0].inside, 0.8, 0.02);
}

TEST_F(RegionPlanesTest, TwoWallsInOneRegionAreNearestOnTheirSides) {
  const Plane other = {Normalized({-0.5f, 0.1f, -1.0f}), 3.0f};
  Support(TiltedPlane(),
          [&](int col, int row) { return col < 80 && IsInside(col, row); });
  Support(other,
          [&](int col, int row) { return col >= 80 && IsInside(col, row); });
  const RegionPlanes planes =
      FindRegionPlanes(regions_, camera_, inner_, rim_, 1, kTolerance, 1);
  const auto& both = planes.of_region[1];
  ASSERT_EQ(both.size(), 2u);
  const bool first = Dot(both[0].plane.normal, other.normal) < 0.999f;
  ExpectPlane(both[first ? 0 : 1], TiltedPlane());
  ExpectPlane(both[first ? 1 : 0], other);
  const size_t left = planes.CellAt(20, 60), right = planes.CellAt(140, 60);
  EXPECT_EQ(both[0].nearness[left] > both[1].nearness[left], first);
  EXPECT_EQ(both[0].nearness[right] > both[1].nearness[right], !first);
}

TEST_F(RegionPlanesTest, RegionsDoNotShareTheirPlanes) {
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 80; col < kWidth; ++col)
      if (IsInside(col, row)) regions_.label[row * kWidth + col] = 2;
  }
  regions_.num_regions = 2;
  Support(TiltedPlane(),
          [&](int col, int row) { return col < 80 && IsInside(col, row); });
  ExpectPlane(Find(1).at(0), TiltedPlane());
  EXPECT_TRUE(Find(2).empty());
}

TEST_F(RegionPlanesTest, TooLittleOrScatteredSupportGivesNoPlane) {
  EXPECT_TRUE(Find().empty());
  Support(TiltedPlane(), [&](int col, int row) {
    return col < 9 && row < 9 && IsInside(col, row);
  });
  EXPECT_TRUE(Find().empty());
  // No twelfth of these lies on one plane.
  inner_.clear();
  rim_.clear();
  Support(TiltedPlane(), [&](int col, int row) { return IsInside(col, row); });
  for (size_t i = 0; i < inner_.size(); ++i) {
    inner_[i].inverse_depth =
        0.1f + 0.9f * std::fmod(0.618034f * static_cast<float>(i), 1.0f);
  }
  EXPECT_TRUE(Find().empty());
}

TEST_F(RegionPlanesTest, APlainRoofIsFoundByItsRim) {
  Support(TiltedPlane(), [&](int col, int row) { return !IsInside(col, row); });
  const std::vector<RegionPlane> found = Find();
  ASSERT_EQ(found.size(), 1u);
  ExpectPlane(found[0], TiltedPlane());
  EXPECT_TRUE(found[0].from_rim);
  EXPECT_NEAR(found[0].rim_on, 1, 1e-6);
  EXPECT_EQ(found[0].rim_behind, 0);
  EXPECT_EQ(found[0].inside, 0);
}

// What lies before the region may have its rim there; what lies behind may not.
TEST_F(RegionPlanesTest, RimPointsBehindAPlaneAreCountedApart) {
  Support(TiltedPlane(), kEverywhere);
  for (size_t i = 0; i < rim_.size(); ++i) {
    if (i % 4 == 0) rim_[i].inverse_depth *= 0.8f;
    if (i % 4 == 1) rim_[i].inverse_depth *= 1.2f;
  }
  const RegionPlane inner = Find().at(0);
  ASSERT_FALSE(inner.from_rim);
  EXPECT_NEAR(inner.rim_on, 0.5, 0.01);
  EXPECT_NEAR(inner.rim_behind, 0.25, 0.01);
}

TEST_F(RegionPlanesTest, PointsInLineHaveNoSpread) {
  Support(TiltedPlane(), [](int, int row) { return row >= 58 && row < 75; });
  const double narrow = Find().at(0).spread;
  inner_.clear();
  rim_.clear();
  Support(TiltedPlane(), kEverywhere);
  EXPECT_GT(Find().at(0).spread, 3 * narrow);
}

TEST_F(RegionPlanesTest, PixelsOnOneLineGiveNoPlane) {
  Support(TiltedPlane(), [](int, int row) { return row == 60; });
  EXPECT_TRUE(Find().empty());
}

TEST_F(RegionPlanesTest, TheSameKeyGivesTheSamePlanes) {
  Support(TiltedPlane(), kEverywhere);
  for (size_t i = 0; i < inner_.size(); ++i)
    inner_[i].inverse_depth += 1e-4f * static_cast<float>(i % 11);
  EXPECT_EQ(Find(1, 5)[0].plane.distance, Find(1, 5)[0].plane.distance);
  EXPECT_NE(Find(1, 5)[0].plane.distance, Find(1, 6)[0].plane.distance);
}

}  // namespace
}  // namespace hpm
