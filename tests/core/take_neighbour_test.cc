#include "src/core/take_neighbour.h"

#include "tests/core/test_cameras.h"

#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// Planes and masks carry the index of the pixel that had them first.
class TakeNeighbourTest : public testing::Test {
 protected:
  TakeNeighbourTest() : planes_(9), costs_(9, 1.0f), masks_(9) {
    params_.ref = MakeTestCamera(3, 3, 3, 0, {0, 0, 0});
    params_.depth_min = 1;
    params_.depth_max = 20;
    for (int i = 0; i < 9; ++i) {
      planes_[i] = {{0, 0, -1}, static_cast<float>(1 + i)};
      masks_[i] = static_cast<uint32_t>(i);
    }
  }

  // Whose hypothesis the pixel has afterwards.
  int Owner(int col, int row) {
    const PixelState state = {
        3, 3, planes_.data(), costs_.data(), masks_.data(), nullptr};
    const std::vector<float> before = costs_;
    const std::vector<Plane> before_planes = planes_;
    TakeNeighbour(params_, state, col, row);
    const int at = 3 * row + col;
    const int owner = static_cast<int>(masks_[at]);
    EXPECT_EQ(planes_[at].distance, before_planes[owner].distance);
    EXPECT_EQ(costs_[at], before[owner]);
    return owner;
  }

  VisitParams params_ = {};
  std::vector<Plane> planes_;
  std::vector<float> costs_;
  std::vector<uint32_t> masks_;
};

TEST_F(TakeNeighbourTest, TakesTheCheapestOfTheFourBesideIt) {
  costs_ = {0, 0.5f, 0, 0.4f, 0.6f, 0.2f, 0, 0.3f, 0};
  EXPECT_EQ(Owner(1, 1), 5);
}

TEST_F(TakeNeighbourTest, InAGeometricPassARefinedPlaneMayCostALittleMore) {
  params_.geometric = true;
  costs_[4] = 0.5f;
  costs_[3] = 0.55f;
  EXPECT_EQ(Owner(1, 1), 3);
}

TEST_F(TakeNeighbourTest, KeepsItsOwnWhereItMatchesClearlyBetter) {
  params_.geometric = true;
  costs_[4] = 0.5f;
  costs_[3] = 0.65f;
  EXPECT_EQ(Owner(1, 1), 4);
}

TEST_F(TakeNeighbourTest, InASearchTheCheaperOneStays) {
  costs_[4] = 0.5f;
  costs_[3] = 0.51f;
  EXPECT_EQ(Owner(1, 1), 4);
  costs_[3] = 0.49f;
  EXPECT_EQ(Owner(1, 1), 3);
}

TEST_F(TakeNeighbourTest, LooksNowhereOutsideTheImage) {
  costs_ = {1, 0.5f, 0, 0.4f, 0, 0, 0, 0, 0};
  EXPECT_EQ(Owner(0, 0), 3);
  costs_ = {0, 0, 0, 0, 0, 0.3f, 0, 0.2f, 1};
  EXPECT_EQ(Owner(2, 2), 7);
}

TEST_F(TakeNeighbourTest, TakesNoDepthOutsideTheRange) {
  costs_ = {1, 0.2f, 1, 0.3f, 0.6f, 1, 1, 1, 1};
  params_.depth_min = 3;  // neighbour 1 lies at 2, neighbour 3 at 4
  EXPECT_EQ(Owner(1, 1), 3);
  params_.depth_max = 3.5f;
  costs_[4] = 0.6f;
  planes_[4].distance = 3.2f;
  masks_[4] = 4;
  EXPECT_EQ(Owner(1, 1), 4);
}

// A plane seen at a grazing angle may turn its back one pixel further.
TEST_F(TakeNeighbourTest, TakesNoPlaneThatFacesAway) {
  costs_ = {1, 1, 1, 0.2f, 0.6f, 0.3f, 1, 1, 1};
  planes_[3] = {Normalized({0.9f, 0, 0.01f}), -5};  // z = 500: only its back
  EXPECT_EQ(Owner(1, 1), 5);
}

}  // namespace
}  // namespace hpm
