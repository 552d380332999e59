#include "src/image/load_image.h"

#include "src/base/error.h"
#include "tests/base/scratch_folder.h"

#include <cmath>
#include <fstream>
#include <functional>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

class LoadImage : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const cv::Mat& image) {
    cv::imwrite((folder_ / name).string(), image);
    return folder_ / name;
  }

  void ExpectBadInput(const std::filesystem::path& path) {
    try {
      LoadGrayImage(path, 8, 8);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      EXPECT_THAT(error.what(), testing::HasSubstr(path.string()));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }

  const ScratchFolder folder_;
};

cv::Mat RandomColours(int width, int height) {
  std::mt19937 random(1);
  cv::Mat image(height, width, CV_8UC3);
  for (int i = 0; i < width * height * 3; ++i) {
    image.data[i] = static_cast<uint8_t>(random());
  }
  return image;
}

TEST_F(LoadImage, GreyIsTheRoundedBt709Luma) {
  const cv::Mat image = RandomColours(97, 61);
  const GrayImage gray = LoadGrayImage(Write("a.png", image), 97, 61);
  ASSERT_EQ(gray.data.size(), 97u * 61u);
  for (int row = 0; row < 61; ++row) {
    for (int col = 0; col < 97; ++col) {
      const auto& bgr = image.at<cv::Vec3b>(row, col);
      // In ten-thousandths, so that halves are exact.
      const int luma = 2126 * bgr[2] + 7152 * bgr[1] + 722 * bgr[0];
      EXPECT_EQ(gray.at(col, row), (luma + 5000) / 10000);
    }
  }
}

TEST_F(LoadImage, BlackAndWhiteStayExact) {
  cv::Mat image(1, 2, CV_8UC3, cv::Scalar::all(0));
  image.at<cv::Vec3b>(0, 1) = {255, 255, 255};
  const GrayImage gray = LoadGrayImage(Write("bw.png", image), 2, 1);
  EXPECT_EQ(gray.at(0, 0), 0);
  EXPECT_EQ(gray.at(1, 0), 255);
}

TEST_F(LoadImage, GreyFilesKeepTheirValues) {
  cv::Mat image(3, 5, CV_8U);
  for (int i = 0; i < 15; ++i) image.data[i] = static_cast<uint8_t>(17 * i);
  const GrayImage gray = LoadGrayImage(Write("grey.png", image), 5, 3);
  for (int i = 0; i < 15; ++i) EXPECT_EQ(gray.data[i], 17 * i);
}

TEST_F(LoadImage, AlphaIsDropped) {
  cv::Mat image(4, 4, CV_8UC4, cv::Scalar(100, 100, 100, 0));
  EXPECT_EQ(LoadGrayImage(Write("alpha.png", image), 4, 4).at(2, 2), 100);
}

TEST_F(LoadImage, SixteenBitsAreReducedToEight) {
  cv::Mat image(4, 4, CV_16UC3, cv::Scalar::all(200 * 257));
  EXPECT_EQ(LoadGrayImage(Write("deep.png", image), 4, 4).at(1, 3), 200);
}

TEST_F(LoadImage, ShrinkingAveragesAreas) {
  cv::Mat image(4, 6, CV_8U);
  for (int i = 0; i < 24; ++i) image.data[i] = static_cast<uint8_t>(10 * i);
  const GrayImage gray = LoadGrayImage(Write("large.png", image), 3, 2);
  ASSERT_EQ(gray.width, 3);
  ASSERT_EQ(gray.height, 2);
  for (int row = 0; row < 2; ++row) {
    for (int col = 0; col < 3; ++col) {
      const int at = 2 * row * 6 + 2 * col;
      const double mean = 10 * (at + at + 1 + at + 6 + at + 7) / 4.0;
      EXPECT_NEAR(gray.at(col, row), mean, 0.5);
    }
  }
}

TEST_F(LoadImage, MissingFileIsBadInput) {
  ExpectBadInput(folder_ / "absent.png");
}

TEST_F(LoadImage, FolderIsBadInput) { ExpectBadInput(folder_.path()); }

TEST_F(LoadImage, GarbageAndEmptyFilesAreBadInput) {
  WriteFile(folder_ / "garbage.jpg", "\xff\xd8\xff this is not a picture");
  ExpectBadInput(folder_ / "garbage.jpg");
  WriteFile(folder_ / "empty.png", "");
  ExpectBadInput(folder_ / "empty.png");
}

TEST_F(LoadImage, FileCutInItsHeaderIsBadInput) {
  const auto path = Write("cut.png", RandomColours(8, 8));
  std::filesystem::resize_file(path, 20);
  ExpectBadInput(path);
}

}  // namespace
}  // namespace hpm
