#include "src/gpu/pixel_tiles.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

template <int kNumLanes>
void ExpectEveryPixelOnce() {
  constexpr int kTilePixels = TileBand<kNumLanes>::kTilePixels;
  for (int log_width = 1; 1 << log_width <= kTilePixels; ++log_width) {
    for (const auto& [width, height] : {std::pair(1, 1),
                                        std::pair(2, 7),
                                        std::pair(64, 64),
                                        std::pair(77, 53)}) {
      std::vector<int> visits(width * height, 0);
      for (int first = 0; first < height; first += 10) {
        for (int color = 0; color < 2; ++color) {
          const TileBand<kNumLanes> band = {width,
                                            height,
                                            first,
                                            std::min(10, height - first),
                                            color,
                                            log_width};
          for (int64_t warp = 0; warp < band.num_warps(); ++warp) {
            for (int lane = 0; lane < kNumLanes; ++lane) {
              const Pixel pixel = PixelOf(band, warp, lane);
              if (!pixel.inside) continue;
              ASSERT_EQ((pixel.col + pixel.row) % 2, color);
              ++visits[pixel.row * width + pixel.col];
            }
          }
        }
      }
      EXPECT_EQ(std::count(visits.begin(), visits.end(), 1), width * height)
          << log_width << ", " << width << "x" << height;
    }
  }
}

// Warps of NVIDIA's and some of AMD's cards, subgroups of others.
TEST(PixelTilesTest, BandsOfBothColorsVisitEveryPixelOnce) {
  ExpectEveryPixelOnce<32>();
  ExpectEveryPixelOnce<64>();
  ExpectEveryPixelOnce<8>();
}

TEST(PixelTilesTest, ReachesTheLastPixelOfLargeImages) {
  // 108 million pixels: more than 2^31 bytes of planes.
  const TileBand<32> band = {12000, 9000, 0, 9000, 1, 3};
  EXPECT_EQ(band.num_warps(), int64_t{1500} * 1125);
  const Pixel last = PixelOf(band, band.num_warps() - 1, 31);
  EXPECT_TRUE(last.inside);
  EXPECT_EQ(last.row, 8999);
  EXPECT_EQ(last.col, 11998);
  const TileBand<32> huge = {1 << 20, 1 << 20, 0, 1 << 20, 0, 3};
  EXPECT_EQ(huge.num_warps(), int64_t{1} << 34);
  EXPECT_EQ(PixelOf(huge, huge.num_warps() - 1, 31).row, (1 << 20) - 1);
}

}  // namespace
}  // namespace hpm
