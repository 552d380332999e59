#include "src/prior/weak_regions.h"

#include <algorithm>
#include <set>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 120, kHeight = 90;

// Two plain halves with a vertical edge between, a checkered patch at top left.
GrayImage TwoHalves() {
  GrayImage image = {kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight)};
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      uint8_t grey = col < kWidth / 2 ? 80 : 180;
      if (col < 30 && row < 30) grey = (col / 3 + row / 3) % 2 == 0 ? 20 : 200;
      image.data[row * kWidth + col] = grey;
    }
  }
  return image;
}

int LabelAt(const WeakRegions& regions, int col, int row) {
  return regions.label[row * regions.width + col];
}

TEST(FindWeakRegions, AnEdgeSeparatesAndTextureBelongsToNone) {
  const WeakRegions regions = FindWeakRegions(TwoHalves(), 2, 0.01f);
  EXPECT_EQ(regions.num_regions, 2);
  EXPECT_GT(LabelAt(regions, 20, 70), 0);
  EXPECT_GT(LabelAt(regions, 100, 20), 0);
  EXPECT_NE(LabelAt(regions, 20, 70), LabelAt(regions, 100, 20));
  EXPECT_EQ(LabelAt(regions, 15, 15), 0);
  EXPECT_EQ(LabelAt(regions, 60, 45), 0);
}

TEST(FindWeakRegions, FillsWindowsUpToItsRim) {
  const WeakRegions regions = FindWeakRegions(TwoHalves(), 2, 0.01f);
  int last = 59;  // of the left half, in this row
  while (LabelAt(regions, last, 70) == 0) --last;
  EXPECT_TRUE(regions.Fills(last - 5, 70, 5));
  EXPECT_FALSE(regions.Fills(last - 4, 70, 5));
  EXPECT_TRUE(regions.Fills(0, kHeight - 1, 5));  // the image's border is none
}

TEST(FindWeakRegions, ShadingUpToTheBoundIsWeak) {
  GrayImage ramp = {kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight)};
  for (int i = 0; i < kWidth * kHeight; ++i)
    ramp.data[i] = static_cast<uint8_t>(i % kWidth * 2);
  EXPECT_EQ(FindWeakRegions(ramp, 2.5f, 0.01f).num_regions, 1);
  EXPECT_EQ(FindWeakRegions(ramp, 1.5f, 0.01f).num_regions, 0);
}

TEST(FindWeakRegions, RegionsBelowTheShareAreLeftOut) {
  // Each half is just under half of the image.
  EXPECT_EQ(FindWeakRegions(TwoHalves(), 2, 0.55f).num_regions, 0);
  EXPECT_EQ(FindWeakRegions(TwoHalves(), 2, 0.35f).num_regions, 2);
}

TEST(FindWeakRegions, NoiseDoesNotBreakAPlainWall) {
  GrayImage wall = {kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight)};
  uint32_t state = 1;
  for (uint8_t& grey : wall.data) {
    state = state * 1664525u + 1013904223u;
    grey = static_cast<uint8_t>(120 + static_cast<int>(state >> 24) % 7 - 3);
  }
  const WeakRegions regions = FindWeakRegions(wall, 2, 0.01f);
  EXPECT_EQ(regions.num_regions, 1);
  EXPECT_GT(std::count(regions.label.begin(), regions.label.end(), 1),
            0.95 * kWidth * kHeight);
}

TEST(FindWeakRegions, TinyImagesAreNoProblem) {
  const WeakRegions regions = FindWeakRegions({1, 1, {7}}, 2, 0.005f);
  EXPECT_EQ(regions.label.size(), 1u);
}

}  // namespace
}  // namespace hpm
