#include "src/core/take_neighbour.h"

#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// Planes and masks carry the index of the pixel that had them first.
class TakeNeighbourTest : public testing::Test {
 protected:
  TakeNeighbourTest() : planes_(9), costs_(9, 1.0f), masks_(9) {
    for (int i = 0; i < 9; ++i) {
      planes_[i] = {{0, 0, -1}, static_cast<float>(i)};
      masks_[i] = static_cast<uint32_t>(i);
    }
  }

  // Whose hypothesis the pixel has afterwards.
  int Owner(int col, int row) {
    const PixelState state = {
        3, 3, planes_.data(), costs_.data(), masks_.data(), nullptr};
    const std::vector<float> before = costs_;
    TakeNeighbour(state, col, row);
    const int at = 3 * row + col;
    const int owner = static_cast<int>(planes_[at].distance);
    EXPECT_EQ(masks_[at], static_cast<uint32_t>(owner));
    EXPECT_EQ(costs_[at], before[owner]);
    return owner;
  }

  std::vector<Plane> planes_;
  std::vector<float> costs_;
  std::vector<uint32_t> masks_;
};

TEST_F(TakeNeighbourTest, TakesTheCheapestOfTheFourBesideIt) {
  costs_ = {0, 0.5f, 0, 0.4f, 0.6f, 0.2f, 0, 0.3f, 0};
  EXPECT_EQ(Owner(1, 1), 5);
}

TEST_F(TakeNeighbourTest, ARefinedPlaneMayCostALittleMore) {
  costs_[4] = 0.5f;
  costs_[3] = 0.55f;
  EXPECT_EQ(Owner(1, 1), 3);
}

TEST_F(TakeNeighbourTest, KeepsItsOwnWhereItMatchesClearlyBetter) {
  costs_[4] = 0.5f;
  costs_[3] = 0.65f;
  EXPECT_EQ(Owner(1, 1), 4);
}

TEST_F(TakeNeighbourTest, LooksNowhereOutsideTheImage) {
  costs_ = {1, 0.5f, 0, 0.4f, 0, 0, 0, 0, 0};
  EXPECT_EQ(Owner(0, 0), 3);
  costs_ = {0, 0, 0, 0, 0, 0.3f, 0, 0.2f, 1};
  EXPECT_EQ(Owner(2, 2), 7);
}

}  // namespace
}  // namespace hpm
