#include "src/gpu/memory_estimate.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

const ProblemSize kLarge = {3200, 2130, 3200, 2130, 20, true};

TEST(MemoryEstimateTest, CoversStateImagesAndDepths) {
  const uint64_t pixels = 3200 * 2130;
  // Plane, prior, cost, two masks, visits, grey; per source grey and
  // depth.
  const uint64_t least = pixels * (16 + 16 + 4 + 4 + 4 + 1 + 1 + 20 * (1 + 3));
  const uint64_t bytes = DeviceBytesNeeded(kLarge, ImageFormat::kByte);
  EXPECT_GE(bytes, least);
  EXPECT_LE(bytes, least + least / 4);
  EXPECT_GT(DeviceBytesNeeded(kLarge, ImageFormat::kQuad), bytes);
}

// Between two sizes, so that what every size takes cannot hide a lack.
TEST(MemoryEstimateTest, EveryByteOfAPixelCounts) {
  const auto bytes = [](int height) {
    return DeviceBytesNeeded({3200, height, 3200, height, 20, true},
                             ImageFormat::kByte);
  };
  // Plane, prior, that of a level, cost, two masks, visits, grey; per
  // source grey and depth; an image on its way.
  const uint64_t least = 16 + 16 + 4 + 4 + 4 + 4 + 1 + 1 + 20 * (1 + 3) + 2;
  EXPECT_GE(bytes(2 * 2176) - bytes(2176), least * 3200 * 2176);
}

TEST(MemoryEstimateTest, IsNotCutAt32Bits) {
  const ProblemSize huge = {12000, 9000, 12000, 9000, 32, true};
  const uint64_t pixels = 12000ull * 9000;
  EXPECT_GT(DeviceBytesNeeded(huge, ImageFormat::kByte),
            pixels * (44 + 32 * 4));
}

TEST(MemoryEstimateTest, CountsImagesThatFit) {
  const uint64_t one = DeviceBytesNeeded(kLarge, ImageFormat::kByte);
  const auto fit = [](uint64_t free_bytes, int num_processors) {
    return ImagesThatFit(
        kLarge, ImageFormat::kByte, free_bytes, num_processors, 3);
  };
  EXPECT_EQ(fit(one, 0), 0);
  EXPECT_EQ(fit(5 * one / 4, 0), 1);
  EXPECT_EQ(fit(100 * one, 0), 3);
  // Stacks of 132 processors: nearly a gigabyte.
  EXPECT_EQ(fit(5 * one / 4, 132), 0);
  EXPECT_EQ(fit(1000, 132), 0);
}

}  // namespace
}  // namespace hpm
