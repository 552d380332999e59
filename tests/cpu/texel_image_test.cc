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

TEST(PackTexels, HoldsTheTwoByTwoNeighbourhoodClampedAtTheBorder) {
  for (int width = 1; width <= 33; ++width) {
    for (const int height : {1, 2, 5}) {
      const GrayImage image = RandomImage(width, height);
      std::vector<uint32_t> texels(image.data.size() + 1, 0xABCDABCD);
      PackTexels(image, texels.data());
      for (int row = 0; row < height; ++row) {
        for (int col = 0; col < width; ++col) {
          const int right = std::min(col + 1, width - 1);
          const int below = std::min(row + 1, height - 1);
          const uint32_t texel = texels[row * width + col];
          EXPECT_EQ(texel & 255, image.at(col, row));
          EXPECT_EQ(texel >> 8 & 255, image.at(right, row));
          EXPECT_EQ(texel >> 16 & 255, image.at(col, below));
          EXPECT_EQ(texel >> 24, image.at(right, below));
        }
      }
      EXPECT_EQ(texels.back(), 0xABCDABCDu);  // nothing written behind the end
    }
  }
}

}  // namespace
}  // namespace hpm
