#include "src/cpu/texel_image.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace hpm {
namespace {

GrayImage RandomImage(int width, int height) {
  std::mt19937 random(width * 100 + height);
  GrayImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    image.data.push_back(static_cast<uint8_t>(random()));
  }
  return image;
}

TEST(PackTexels, TwoTexelsHoldTheTwoByTwoNeighbourhood) {
  for (int width = 1; width <= 33; ++width) {
    for (const int height : {1, 2, 5}) {
      const GrayImage image = RandomImage(width, height);
      std::vector<Texel> texels(image.data.size() + kTexelPadding, 0xABCD);
      PackTexels(image, texels.data());
      for (int row = 0; row < height; ++row) {
        for (int col = 0; col < width; ++col) {
          const int below = std::min(row + 1, height - 1);
          const uint8_t* taps =
              reinterpret_cast<const uint8_t*>(&texels[row * width + col]);
          EXPECT_EQ(taps[0], image.at(col, row));
          EXPECT_EQ(taps[1], image.at(col, below));
          if (col + 1 == width) continue;
          EXPECT_EQ(taps[2], image.at(col + 1, row));
          EXPECT_EQ(taps[3], image.at(col + 1, below));
        }
      }
      EXPECT_EQ(texels.back(), 0xABCD);  // nothing written behind the end
    }
  }
}

}  // namespace
}  // namespace hpm
