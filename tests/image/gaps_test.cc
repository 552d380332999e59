#include "src/image/gaps.h"

#include "src/base/error.h"
#include "src/image/load_image.h"
#include "src/image/shrink_image.h"
#include "tests/base/scratch_folder.h"

#include <algorithm>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

using testing::ElementsAre;

GrayImage Filled(int width, int height, uint8_t value) {
  return {width,
          height,
          std::vector<uint8_t>(static_cast<size_t>(width) * height, value)};
}

void Fill(GrayImage* image, int left, int top, int right, int bottom) {
  for (int row = top; row < bottom; ++row) {
    for (int col = left; col < right; ++col)
      image->data[static_cast<size_t>(row) * image->width + col] = 0;
  }
}

TEST(Gaps, MaskedPixelsBecomeZeroAndNoOtherOneIs) {
  GrayImage image{4, 1, {0, 5, 0, 255}};
  ApplyMask({4, 1, {255, 0, 0, 1}}, &image);
  EXPECT_TRUE(image.has_gaps);
  EXPECT_THAT(image.data, ElementsAre(1, 0, 0, 255));
  EXPECT_FALSE(image.IsGap(0));
  EXPECT_TRUE(image.IsGap(1));
}

TEST(Gaps, AMaskWithoutAMaskedPixelChangesNothing) {
  GrayImage image{4, 1, {0, 5, 0, 255}};
  ApplyMask({4, 1, {255, 255, 1, 255}}, &image);
  EXPECT_FALSE(image.has_gaps);
  EXPECT_THAT(image.data, ElementsAre(0, 5, 0, 255));
  EXPECT_FALSE(image.IsGap(0));
}

TEST(Gaps, ShrunkImagesDoNotMixWhatShowsNothingWithWhatDoes) {
  GrayImage image{4, 2, {0, 8, 0, 0, 4, 6, 0, 9}};
  image.has_gaps = true;
  const GrayImage half = ShrinkImage(image, 1);
  EXPECT_TRUE(half.has_gaps);
  EXPECT_THAT(half.data, ElementsAre(6, 0));
  image.has_gaps = false;
  EXPECT_THAT(ShrinkImage(image, 1).data, ElementsAre(5, 2));
}

TEST(Gaps, AMaskIsScaledWithItsImage) {
  GrayImage mask = Filled(8, 8, 255);
  Fill(&mask, 0, 0, 3, 8);
  const GrayImage half = ResizedMask(mask, 4, 4);
  for (int row = 0; row < 4; ++row) {
    EXPECT_EQ(half.at(0, row), 0);
    EXPECT_NE(half.at(1, row), 0);  // half of it is masked
    EXPECT_NE(half.at(3, row), 0);
  }
}

// A dark chair that the border of the picture cuts is no border of it.
TEST(Gaps, OnlyMasksMakeThemWhenAnImageIsLoaded) {
  const ScratchFolder folder;
  cv::Mat picture(40, 60, CV_8UC3, cv::Scalar(90, 90, 90));
  picture.rowRange(0, 8).setTo(cv::Scalar(0, 0, 0));
  cv::imwrite((folder / "a.png").string(), picture);
  ImageDecoding decoding;
  EXPECT_FALSE(LoadGrayImage(folder / "a.png", 30, 20, decoding).has_gaps);
  cv::Mat mask(40, 60, CV_8U, cv::Scalar(255));
  mask.colRange(50, 60).setTo(cv::Scalar(0));
  cv::imwrite((folder / "mask.png").string(), mask);
  decoding.mask = folder / "mask.png";
  const GrayImage image = LoadGrayImage(folder / "a.png", 30, 20, decoding);
  EXPECT_TRUE(image.has_gaps);
  for (int row = 0; row < 20; ++row) {
    for (int col = 0; col < 30; ++col)
      EXPECT_EQ(image.at(col, row), col >= 25 ? 0 : row < 4 ? 1 : 90);
  }
}

// In 16 bits 1 is as little black as in 8.
TEST(Gaps, OnlyZeroMasksWhateverTheBits) {
  const ScratchFolder folder;
  for (const int type : {CV_8U, CV_16U}) {
    cv::Mat samples = cv::Mat::zeros(1, 4, type);
    samples.col(1).setTo(1);
    samples.col(2).setTo(200);
    if (type == CV_16U) samples.col(2).setTo(65535);
    cv::imwrite((folder / "mask.png").string(), samples);
    EXPECT_THAT(LoadMask(folder / "mask.png").data,
                ElementsAre(0, 255, 255, 0));
  }
}

// What is missing is not to be filled with black or white.
TEST(Gaps, AMaskThatIsNoWholeImageIsNamed) {
  const ScratchFolder folder;
  const std::filesystem::path path = folder / "mask.jpg";
  cv::Mat noise(40, 60, CV_8U);
  cv::randu(noise, 0, 256);
  cv::imwrite(path.string(), noise);
  EXPECT_EQ(LoadMask(path).width, 60);
  std::filesystem::resize_file(path, std::filesystem::file_size(path) / 2);
  for (const bool is_cut : {true, false}) {
    if (!is_cut) WriteFile(path, "nothing");
    try {
      LoadMask(path);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      EXPECT_THAT(error.what(), testing::StartsWith(path.string() + ": "));
    }
  }
}

}  // namespace
}  // namespace hpm
