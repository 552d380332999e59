#include "src/prior/weak_regions.h"

#include "src/core/rng.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>
#include <opencv2/imgproc.hpp>

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

// Labels in the order in which the image is read, by flooding it pixel by
// pixel.
std::vector<uint16_t> FloodedRegions(const GrayImage& image,
                                     float max_gradient,
                                     int min_area) {
  const cv::Mat grey(image.height,
                     image.width,
                     CV_8U,
                     const_cast<uint8_t*>(image.data.data()));
  cv::Mat blurred, dx, dy, gradient;
  grey.convertTo(blurred, CV_32F);
  cv::GaussianBlur(blurred, blurred, cv::Size(), 1.0);
  cv::Sobel(blurred, dx, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(blurred, dy, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::magnitude(dx, dy, gradient);
  cv::Mat weak = gradient < max_gradient;
  const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::erode(weak, weak, square);
  cv::Mat kept = cv::Mat::zeros(weak.size(), CV_16U);
  uint16_t num_regions = 0;
  for (int at = 0; at < weak.rows * weak.cols; ++at) {
    std::vector<cv::Point> flood;
    const auto wet = [&](int col, int row) {
      if (col < 0 || row < 0 || col >= weak.cols || row >= weak.rows) return;
      if (weak.at<uint8_t>(row, col) == 0) return;
      weak.at<uint8_t>(row, col) = 0;
      flood.emplace_back(col, row);
    };
    wet(at % weak.cols, at / weak.cols);
    for (size_t i = 0; i < flood.size(); ++i) {
      const auto [col, row] = std::pair(flood[i].x, flood[i].y);
      wet(col - 1, row);
      wet(col + 1, row);
      wet(col, row - 1);
      wet(col, row + 1);
    }
    if (static_cast<int>(flood.size()) < std::max(1, min_area)) continue;
    ++num_regions;
    for (const cv::Point& p : flood) kept.at<uint16_t>(p) = num_regions;
  }
  cv::Mat grown;
  cv::dilate(kept, grown, square);
  std::vector<uint16_t> labels;
  for (int at = 0; at < weak.rows * weak.cols; ++at) {
    const auto own = kept.at<uint16_t>(at / weak.cols, at % weak.cols);
    labels.push_back(
        own > 0 ? own : grown.at<uint16_t>(at / weak.cols, at % weak.cols));
  }
  return labels;
}

// Shadings that are just weak and just not, with specks: regions of all shapes
// meet in several bands of rows.
GrayImage Blotches(int width, int height, uint64_t key) {
  GrayImage image = {width, height, std::vector<uint8_t>(width * height)};
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      Rng rng(key, col, row);
      const float shade = 60 + 25 * std::sin(0.062f * static_cast<float>(col)) +
                          25 * std::cos(0.05f * static_cast<float>(row));
      const bool speck = rng.Uniform() < 0.004f;
      image.data[row * width + col] =
          static_cast<uint8_t>(speck ? 250 : shade + rng.Uniform());
    }
  }
  return image;
}

TEST(FindWeakRegions, ManyBandsOfRowsAreOneImage) {
  for (const int height : {1, 63, 64, 65, 300}) {
    const GrayImage image = Blotches(257, height, height);
    const WeakRegions regions = FindWeakRegions(image, 1.4f, 0.0005f);
    EXPECT_EQ(regions.label,
              FloodedRegions(image,
                             1.4f,
                             static_cast<int>(std::ceil(
                                 static_cast<double>(0.0005f) * 257 * height))))
        << height;
    if (height == 300) {
      EXPECT_GT(regions.num_regions, 5);
    }
  }
}

// The farthest tap of the blur decides.
TEST(FindWeakRegions, ABrightLineReachesAsFarIntoTheNextBand) {
  for (int line = 50; line < 80; ++line) {
    GrayImage image = {20, 130, std::vector<uint8_t>(20 * 130, 0)};
    std::fill_n(image.data.begin() + 20 * line, 20, uint8_t{255});
    EXPECT_EQ(FindWeakRegions(image, 0.001f, 0.01f).label,
              FloodedRegions(image, 0.001f, 26))
        << line;
  }
}

TEST(WeakRegions, BandsMakeUpTheImage) {
  WeakRegions regions;
  regions.width = 10;
  regions.height = 200;
  std::vector<std::atomic<int>> num_visits(regions.height);
  regions.ForEachBand([&](const Rows& rows) {
    EXPECT_EQ(rows.begin % 64, 0);
    for (int row = rows.begin; row < rows.end; ++row) ++num_visits[row];
  });
  for (const auto& count : num_visits) EXPECT_EQ(count, 1);
}

TEST(LabelWindows, HoldTheLeastAndTheGreatestAsFarAsTheImageReaches) {
  constexpr int kRadius = 3;
  const GrayImage image = Blotches(90, 150, 3);
  const WeakRegions regions = FindWeakRegions(image, 1.4f, 0.0005f);
  regions.ForEachBand([&](const Rows& rows) {
    const LabelWindows windows(regions, rows, kRadius);
    for (int row = rows.begin; row < rows.end; ++row) {
      for (int col = 0; col < regions.width; ++col) {
        int least = regions.At(col, row), greatest = least;
        for (int r = std::max(0, row - kRadius);
             r <= std::min(regions.height - 1, row + kRadius);
             ++r) {
          for (int c = std::max(0, col - kRadius);
               c <= std::min(regions.width - 1, col + kRadius);
               ++c) {
            least = std::min(least, regions.At(c, r));
            greatest = std::max(greatest, regions.At(c, r));
          }
        }
        ASSERT_EQ(windows.Least(col, row), least) << col << " " << row;
        ASSERT_EQ(windows.Greatest(col, row), greatest) << col << " " << row;
      }
    }
  });
}

TEST(FindWeakRegions, TinyImagesAreNoProblem) {
  const WeakRegions regions = FindWeakRegions({1, 1, {7}}, 2, 0.005f);
  EXPECT_EQ(regions.label.size(), 1u);
}

}  // namespace
}  // namespace hpm
