#include "colmap_plugin/controller/run_budget.h"

#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_plan.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"
#include "tests/engine/still_backend.h"

#include <algorithm>
#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

class RunBudgetTest : public testing::Test {
 protected:
  void WriteImage(int image, const char* extension, int factor, int type) {
    std::vector<unsigned char> bytes;
    cv::imencode(extension,
                 cv::Mat(30 * factor, 40 * factor, type, cv::Scalar::all(9)),
                 bytes);
    WriteFile(scene_.path() / "images" / ViewName(image),
              {reinterpret_cast<char*>(bytes.data()), bytes.size()});
  }

  uint64_t Decoded(int image, const std::filesystem::path& masks = {}) {
    return DecodedBytes(scene_.Open(/*max_image_size=*/40, masks), image);
  }

  uint64_t FileBytes(int image) {
    return std::filesystem::file_size(scene_.path() / "images" /
                                      ViewName(image));
  }

  uint64_t Working() {
    const auto backend = MakeCpuBackend(FindCpuTarget("scalar"), 1);
    return Working({backend.get()});
  }
  uint64_t Working(const std::vector<const Backend*>& backends) {
    StereoProblem problem;
    problem.ref_image = 0;
    problem.src_images = {1, 2};
    return LargestNeeds(scene_.Open(40), {problem}, backends, true).working;
  }

  SceneWorkspace scene_{SmallScene(3, 40, 30)};
};

TEST_F(RunBudgetTest, AFileIsReadAndDecodedAsAWhole) {
  WriteImage(0, ".png", 10, CV_8UC3);
  EXPECT_EQ(Decoded(0), FileBytes(0) + 400u * 300u * 4u);
  WriteImage(0, ".png", 10, CV_16UC3);
  EXPECT_EQ(Decoded(0), FileBytes(0) + 400u * 300u * 12u);
  WriteImage(0, ".tif", 10, CV_32FC3);
  EXPECT_EQ(Decoded(0), FileBytes(0) + 400u * 300u * 20u);
  std::filesystem::remove(scene_.path() / "images" / ViewName(0));
  EXPECT_EQ(Decoded(0), 0u);
}

TEST_F(RunBudgetTest, ALargeJpegIsDecodedAtReducedScale) {
  WriteImage(0, ".jpg", 10, CV_8UC3);
  EXPECT_EQ(Decoded(0), FileBytes(0) + 200u * 150u * 4u);
  WriteImage(0, ".jpg", 16, CV_8UC3);
  EXPECT_EQ(Decoded(0), FileBytes(0) + 160u * 120u * 4u);
}

TEST_F(RunBudgetTest, AMaskIsDecodedAtFullSizeAfterItsImage) {
  WriteImage(0, ".jpg", 16, CV_8UC3);
  const std::filesystem::path masks = scene_.path() / "masks";
  const std::filesystem::path mask = masks / (ViewName(0) + ".png");
  std::filesystem::create_directory(masks);
  cv::imwrite(mask.string(), cv::Mat(480, 640, CV_8U, cv::Scalar(1)));
  EXPECT_EQ(Decoded(0, masks),
            std::filesystem::file_size(mask) + 640u * 480u * 2u);
  cv::imwrite(mask.string(), cv::Mat(480, 640, CV_16U, cv::Scalar(1)));
  EXPECT_EQ(Decoded(0, masks),
            std::filesystem::file_size(mask) + 640u * 480u * 3u);
}

TEST_F(RunBudgetTest, OneLargeSourceCounts) {
  const uint64_t others =
      Working() - std::max({Decoded(0), Decoded(1), Decoded(2)});
  WriteImage(2, ".png", 15, CV_8UC3);
  EXPECT_EQ(Decoded(2), FileBytes(2) + 225u * 40u * 30u * 4u);
  EXPECT_EQ(Working(), others + Decoded(2));
}

// A run that goes on with the CPU when its card fails needs memory for both.
TEST_F(RunBudgetTest, TheHungriestBackendCounts) {
  const auto cpu = MakeCpuBackend(FindCpuTarget("scalar"), 1);
  StillBackend modest(nullptr);
  EXPECT_LT(Working({&modest}), Working());
  EXPECT_EQ(Working({&modest, cpu.get()}), Working());
  EXPECT_EQ(Working({cpu.get(), &modest}), Working());
}

// A run is refused only where not even one image fits.
TEST(ImagesInMemoryTest, WhatItAllowsIsNotRefused) {
  constexpr uint64_t mib = 1 << 20;
  for (uint64_t limit = 64 * mib; limit <= 4096 * mib; limit += 64 * mib) {
    for (const uint64_t working : {1 * mib, 30 * mib, 300 * mib}) {
      for (const uint64_t inputs : {1 * mib, 30 * mib, 300 * mib}) {
        const MemoryNeeds needs = {working, inputs, 0};
        const uint64_t n = ImagesInMemory(needs, 8, limit);
        if (n == 1) continue;
        EXPECT_NO_THROW(PlanCacheBytes(0, n * working, n * inputs, limit))
            << n << " of " << working << " and " << inputs << " in " << limit;
      }
    }
  }
  const MemoryNeeds needs = {100 * mib, 50 * mib, 0};
  EXPECT_EQ(ImagesInMemory(needs, 8, 1200 * mib), 4);
  EXPECT_EQ(ImagesInMemory(needs, 3, 1200 * mib), 3);
  EXPECT_EQ(ImagesInMemory(needs, 8, 100 * mib), 1);
}

TEST(DecodesAtOnceTest, FitIntoWhatMatchingTakes) {
  MemoryNeeds needs;
  needs.working = 900;
  needs.decoding = 100;
  EXPECT_EQ(DecodesAtOnce(needs), 2);
  needs.decoding = 800;
  EXPECT_EQ(DecodesAtOnce(needs), 1);
  needs.decoding = 1;
  EXPECT_EQ(DecodesAtOnce(needs), 8);
  needs.decoding = 0;
  EXPECT_EQ(DecodesAtOnce(needs), 8);
}

}  // namespace
}  // namespace hpm
