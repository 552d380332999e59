#include "colmap_plugin/controller/preview.h"

#include "tests/base/scratch_folder.h"

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

constexpr int kWidth = 64;
constexpr int kHeight = 48;

// Near on the left, far on the right, nothing in the lower half.
DepthAndNormal Maps() {
  DepthAndNormal maps;
  maps.depth = {kWidth, kHeight, 1, std::vector<float>(kWidth * kHeight, 0)};
  maps.normal = {
      kWidth, kHeight, 3, std::vector<float>(3 * kWidth * kHeight, 0)};
  for (int row = 0; row < kHeight / 2; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const int at = row * kWidth + col;
      maps.depth.data[at] = col < kWidth / 2 ? 2 : 8;
      maps.normal.data[2 * kWidth * kHeight + at] = -1;
    }
  }
  return maps;
}

class Preview : public testing::Test {
 protected:
  cv::Mat Read(const std::string& name) const {
    return cv::imread((folder_ / name).string());
  }
  const ScratchFolder folder_;
};

TEST_F(Preview, PicturesHaveTheSizeOfTheMaps) {
  WritePreviews(folder_.path(), "a.png", Maps());
  for (const char* name : {"a.png.depth.jpg", "a.png.normal.jpg"}) {
    const cv::Mat picture = Read(name);
    EXPECT_EQ(picture.cols, kWidth) << name;
    EXPECT_EQ(picture.rows, kHeight) << name;
  }
}

TEST_F(Preview, NearIsWarmFarIsCoolNothingIsBlack) {
  WritePreviews(folder_.path(), "a.png", Maps());
  const cv::Mat depth = Read("a.png.depth.jpg");
  const auto near = depth.at<cv::Vec3b>(10, 10);  // blue, green, red
  const auto far = depth.at<cv::Vec3b>(10, 54);
  EXPECT_GT(near[2], near[0] + 50);
  EXPECT_GT(far[0], far[1]);
  const auto none = depth.at<cv::Vec3b>(40, 30);
  EXPECT_LT(none[0] + none[1] + none[2], 30);
}

TEST_F(Preview, FacingNormalsAreLightBlue) {
  WritePreviews(folder_.path(), "a.png", Maps());
  const auto colour = Read("a.png.normal.jpg").at<cv::Vec3b>(10, 10);
  EXPECT_NEAR(colour[0], 255, 12);
  EXPECT_NEAR(colour[1], 128, 12);
  EXPECT_NEAR(colour[2], 128, 12);
}

TEST_F(Preview, EmptyMapsGiveBlackPictures) {
  DepthAndNormal maps = Maps();
  for (float& z : maps.depth.data) z = 0;
  for (float& n : maps.normal.data) n = 0;
  WritePreviews(folder_.path(), "a.png", maps);
  EXPECT_LT(cv::norm(Read("a.png.depth.jpg"), cv::NORM_INF), 10);
  EXPECT_LT(cv::norm(Read("a.png.normal.jpg"), cv::NORM_INF), 10);
}

}  // namespace
}  // namespace hpm
