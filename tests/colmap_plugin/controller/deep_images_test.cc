#include "colmap_plugin/controller/deep_images.h"

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/formats/map_file.h"
#include "src/base/error.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

constexpr int kNumImages = 4;
constexpr int kWidth = 40;
constexpr int kHeight = 30;

class DeepImagesTest : public testing::Test {
 protected:
  // Grey values `offset` + `scale` times those of 8 bits, whatever the name of
  // the file says.
  void Deepen(int image, int type, double scale, double offset = 0) {
    const auto path = scene_.path() / "images" / ViewName(image);
    const cv::Mat grey(kHeight, kWidth, CV_8U, Eight(image).data.data());
    cv::Mat deep;
    grey.convertTo(deep, type, scale, offset);
    std::vector<unsigned char> bytes;
    ASSERT_TRUE(cv::imencode(".tif", deep, bytes));
    WriteFile(path, {reinterpret_cast<char*>(bytes.data()), bytes.size()});
  }
  void DeepenAll(int type, double scale, double offset = 0) {
    for (int i = 0; i < kNumImages; ++i) Deepen(i, type, scale, offset);
  }

  // As the scene was made.
  GrayImage& Eight(int image) {
    if (eight_.empty()) {
      const Workspace workspace = scene_.Open();
      for (int i = 0; i < kNumImages; ++i)
        eight_.push_back(
            LoadGrayImage(workspace.ImagePath(i), kWidth, kHeight));
    }
    return eight_[image];
  }

  std::optional<GreyRange> Find() {
    log_.clear();
    const Workspace workspace = scene_.Open();
    ImageContents contents(workspace);
    return FindDeepRange(
        workspace,
        &contents,
        [this](LogLevel, const std::string& line) { log_.push_back(line); },
        CancelToken());
  }

  // Every step of the 8 bits is still there.
  void ExpectContrastKept(const GreyRange& range) {
    Workspace workspace = scene_.Open();
    workspace.StretchDeepImages(range);
    const GrayImage gray = LoadGrayImage(
        workspace.ImagePath(1), kWidth, kHeight, workspace.Decoding(1));
    double sum = 0, sum_eight = 0;
    for (size_t i = 1; i < gray.data.size(); ++i) {
      sum += std::abs(gray.data[i] - gray.data[i - 1]);
      sum_eight += std::abs(Eight(1).data[i] - Eight(1).data[i - 1]);
    }
    EXPECT_GT(sum, 0.95 * sum_eight);
  }

  RunSummary Run() {
    ControllerOptions options;
    options.workspace.path = scene_.path();
    options.hpm.method = "nesp";
    options.hpm.num_iterations = 2;
    options.patch_match.geom_consistency = false;
    return PatchMatchController(
               options,
               [](LogLevel, const std::string&) {},
               [](const ProgressEvent&) {},
               CancelToken())
        .Run();
  }

  std::string DepthBytes(int image) const {
    return ReadFile(scene_.path() / "stereo/depth_maps" /
                    (ViewName(image) + ".photometric.bin"));
  }

  std::filesystem::path Record() const {
    return scene_.path() / "stereo/hpm_mvs/deep_images.json";
  }

  SceneWorkspace scene_{SmallScene(kNumImages, kWidth, kHeight)};
  std::vector<GrayImage> eight_;
  std::vector<std::string> log_;
};

TEST_F(DeepImagesTest, EightBitsAreLeftAlone) {
  EXPECT_FALSE(Find());
  EXPECT_THAT(log_, testing::IsEmpty());
  EXPECT_FALSE(std::filesystem::exists(Record()));
}

TEST_F(DeepImagesTest, SixteenBitsThatAreUsedAreCutAsEver) {
  DeepenAll(CV_16U, 257);
  Deepen(0, CV_16U, 256, 255);
  EXPECT_FALSE(Find());
}

TEST_F(DeepImagesTest, TwelveBitsInSixteenAreStretched) {
  DeepenAll(CV_16U, 16);
  const auto range = Find();
  ASSERT_TRUE(range);
  EXPECT_LE(range->high, 255 * 16);
  ASSERT_EQ(log_.size(), 1u);
  EXPECT_THAT(log_[0], testing::HasSubstr("4 images"));
  ExpectContrastKept(*range);
}

TEST_F(DeepImagesTest, ThermalCountsAreStretchedWithoutTheBlackBorder) {
  DeepenAll(CV_16U, 5, 7200);
  Eight(0).data.assign(Eight(0).data.size(), 0);
  Deepen(2, CV_16U, 5, 7200);
  const auto range = Find();
  ASSERT_TRUE(range);
  EXPECT_GE(range->low, 7200);
  ExpectContrastKept(*range);
}

TEST_F(DeepImagesTest, FloatingPointIsStretched) {
  DeepenAll(CV_32F, 1 / 255.0, -0.5);
  const auto range = Find();
  ASSERT_TRUE(range);
  EXPECT_GE(range->low, -0.5);
  EXPECT_LE(range->high, 0.5);
  ExpectContrastKept(*range);
  EXPECT_THAT(Run().failed, testing::IsEmpty());
}

TEST_F(DeepImagesTest, WhatWasFoundIsRememberedUntilAFileChanges) {
  DeepenAll(CV_16U, 16);
  const auto first = Find();
  ASSERT_TRUE(first);
  const std::string record = ReadFile(Record());
  const auto time = std::filesystem::last_write_time(Record());
  EXPECT_EQ(Find()->high, first->high);
  EXPECT_EQ(std::filesystem::last_write_time(Record()), time);
  WriteFile(Record(), "[damaged");
  EXPECT_EQ(Find()->high, first->high);
  EXPECT_EQ(ReadFile(Record()), record);
  Deepen(3, CV_16U, 32);
  EXPECT_GT(Find()->high, 1.5 * first->high);
}

TEST_F(DeepImagesTest, APartOfTheImagesGetsTheMapsOfAWholeRun) {
  DeepenAll(CV_16U, 5, 7200);
  Deepen(3, CV_16U, 20, 5000);
  const auto cfg = scene_.path() / "stereo/patch-match.cfg";
  const std::string whole = ReadFile(cfg);
  WriteFile(cfg, ViewName(1) + "\n" + ViewName(0) + ", " + ViewName(2) + "\n");
  EXPECT_EQ(Run().num_computed, 1);
  const std::string part = DepthBytes(1);
  std::string all;
  for (int i = 0; i < kNumImages; ++i)
    all += ViewName(i) + "\n" +
           (i == 1 ? ViewName(0) + ", " + ViewName(2) : ViewName(1)) + "\n";
  WriteFile(cfg, all);
  EXPECT_EQ(Run().num_kept, 1);
  std::filesystem::remove_all(scene_.path() / "stereo/depth_maps");
  EXPECT_EQ(Run().num_computed, kNumImages);
  EXPECT_EQ(DepthBytes(1), part);
}

TEST_F(DeepImagesTest, AnotherRangeMakesAllMapsAnew) {
  DeepenAll(CV_16U, 16);
  // Image 3 takes no part but in the range.
  WriteFile(scene_.path() / "stereo/patch-match.cfg",
            ViewName(0) + "\n" + ViewName(1) + "\n");
  EXPECT_EQ(Run().num_computed, 1);
  EXPECT_EQ(Run().num_computed, 0);
  Deepen(3, CV_16U, 32);
  EXPECT_EQ(Run().num_computed, 1);
}

}  // namespace
}  // namespace hpm
