// Whole runs over a small workspace, in process.
#include "colmap_plugin/controller/controller.h"

#include "src/base/error.h"
#include "src/engine/schedule.h"
#include "tests/colmap_plugin/controller/controller_fixture.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST_F(ControllerTest, WritesBothStagesOfEveryImage) {
  const RunSummary summary = Run();
  EXPECT_EQ(summary.num_problems, kNumImages);
  EXPECT_EQ(summary.num_computed, kNumImages);
  EXPECT_THAT(summary.failed, testing::IsEmpty());
  EXPECT_GT(summary.valid_pixel_share, 0.5);
  for (int i = 0; i < kNumImages; ++i) {
    for (const char* stage : {"photometric", "geometric"}) {
      const Map depth = ReadMap(MapPath("depth_maps", i, stage));
      const Map normal = ReadMap(MapPath("normal_maps", i, stage));
      EXPECT_EQ(depth.width, kWidth);
      EXPECT_EQ(depth.height, kHeight);
      EXPECT_EQ(normal.channels, 3);
      const size_t size = depth.data.size();
      for (size_t k = 0; k < size; ++k) {
        const float length = std::hypot(
            normal.data[k], normal.data[size + k], normal.data[2 * size + k]);
        ASSERT_NEAR(length, depth.data[k] > 0 ? 1 : 0, 1e-4);
      }
    }
  }
}

TEST_F(ControllerTest, ValidDepthsAreTrue) {
  options_.hpm.num_iterations = 3;
  options_.hpm.num_geom_iterations = 2;
  Run();
  const TrueMaps truth =
      RenderTrueMaps(MakeTiltedPlane(SmallScene(kNumImages, kWidth, kHeight)),
                     scene_.views()[1].camera,
                     -0.5);  // on the rays of COLMAP's files
  const std::vector<float> depth = Depth(1, "geometric");
  int num_valid = 0, num_true = 0;
  for (size_t i = 0; i < depth.size(); ++i) {
    if (depth[i] == 0) continue;
    ++num_valid;
    num_true += std::abs(depth[i] / truth.depth[i] - 1) < 0.02;
  }
  EXPECT_GT(num_valid, kWidth * kHeight / 2);
  EXPECT_GT(num_true, 0.9 * num_valid);
}

// The surface reaches out of the range: what lies outside is found, not
// replaced by something false inside.
TEST_F(ControllerTest, NothingOutsideAGivenRangeIsPublished) {
  const TrueMaps truth =
      RenderTrueMaps(MakeTiltedPlane(SmallScene(kNumImages, kWidth, kHeight)),
                     scene_.views()[1].camera,
                     -0.5);
  std::vector<float> sorted = truth.depth;
  std::sort(sorted.begin(), sorted.end());
  const float nearest = sorted.front(), middle = sorted[sorted.size() / 2];
  for (const auto& [min, max] :
       {std::pair(nearest, middle), {0.7f * nearest, 0.85f * nearest}}) {
    options_.problems.depth_min = min;
    options_.problems.depth_max = max;
    Run();
    const std::vector<float> depth = Depth(1, "geometric");
    int num_published = 0, num_false = 0;
    for (size_t i = 0; i < depth.size(); ++i) {
      if (depth[i] == 0) continue;
      EXPECT_GE(depth[i], min);
      EXPECT_LE(depth[i], max);
      ++num_published;
      num_false += std::abs(depth[i] / truth.depth[i] - 1) > 0.05;
    }
    EXPECT_LT(num_false, 0.01 * kWidth * kHeight);
    if (max > nearest) {
      EXPECT_GT(num_published, 0.3 * kWidth * kHeight);
    }
  }
}

// The photometric maps are cut, too, once nobody reads them, and made whole
// again for whoever does.
TEST_F(ControllerTest, InputMapsAreCutWhenTheRunIsComplete) {
  options_.problems.depth_min = 4.5;
  options_.problems.depth_max = 5;
  Run();
  const auto num_outside = [&](int image) {
    const std::vector<float> depth = Depth(image, "photometric");
    return std::count_if(depth.begin(), depth.end(), [](float z) {
      return z != 0 && (z < 4.5f || z > 5);
    });
  };
  for (int i = 0; i < kNumImages; ++i) EXPECT_EQ(num_outside(i), 0);
  const std::vector<float> expected = Depth(1, "geometric");
  EXPECT_EQ(Run().num_kept, kNumImages);
  std::filesystem::remove(MapPath("depth_maps", 1, "geometric"));
  Run();
  EXPECT_EQ(Depth(1, "geometric"), expected);
  for (int i = 0; i < kNumImages; ++i) EXPECT_EQ(num_outside(i), 0);
  // Another range, of the same search.
  options_.problems.depth_max = 5.2;
  EXPECT_EQ(Run().num_computed, kNumImages);
}

// The maps of a few references are those of a run over all images, byte for
// byte, and nothing of the others is published or left behind.
TEST_F(ControllerTest, AFewReferencesGetTheMapsOfTheFullRun) {
  for (const char* method : {"nesp", "hpm_plus"}) {
    options_.hpm.method = method;
    options_.hpm.num_levels = 2;
    Run();
    const std::vector<float> expected = Depth(1, "geometric");
    for (const char* folder : {"depth_maps", "normal_maps", "hpm_mvs"})
      std::filesystem::remove_all(scene_.path() / "stereo" / folder);
    const std::filesystem::path cfg = scene_.path() / "stereo/patch-match.cfg";
    const std::string all = ReadFile(cfg);
    WriteFile(cfg, ViewName(1) + "\n__auto__, 20\n");
    const RunSummary summary = Run();
    EXPECT_EQ(summary.num_problems, 1);
    EXPECT_EQ(summary.num_computed, 1);
    EXPECT_EQ(summary.num_fusable, 1);
    EXPECT_EQ(Depth(1, "geometric"), expected) << method;
    EXPECT_THAT(FilesNamedLike(ViewName(0) + ".photometric.bin"),
                testing::IsEmpty());
    EXPECT_THAT(FilesNamedLike(".depth.bin"), testing::IsEmpty());
    EXPECT_EQ(Run().num_kept, 1);
    WriteFile(cfg, all);
    Run();
    EXPECT_EQ(Depth(1, "geometric"), expected) << method;
  }
}

TEST_F(ControllerTest, ASourceThatCannotBeReadFailsNobodyElse) {
  WriteFile(scene_.path() / "stereo/patch-match.cfg",
            ViewName(1) + "\n__auto__, 20\n");
  std::filesystem::remove(scene_.path() / "images" / ViewName(3));
  options_.patch_match.allow_missing_files = true;
  const RunSummary summary = Run();
  EXPECT_THAT(summary.failed, testing::IsEmpty());
  EXPECT_GT(summary.valid_pixel_share, 0.5);
}

TEST_F(ControllerTest, ProgressNeverFallsAndEndsAtOne) {
  Run();
  ASSERT_FALSE(events_.empty());
  double before = 0;
  for (const ProgressEvent& event : events_) {
    EXPECT_GE(event.fraction, before - 1e-9);
    EXPECT_LE(event.image_number, event.num_images);
    before = event.fraction;
  }
  EXPECT_NEAR(events_.back().fraction, 1, 1e-9);
}

TEST_F(ControllerTest, CancelledRunThrowsAndLeavesNoTornFiles) {
  on_progress_ = [this](const ProgressEvent& event) {
    if (event.image_number == 2) cancel_.Cancel();
  };
  try {
    Run();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInterrupted);
  }
  EXPECT_FALSE(
      std::filesystem::exists(MapPath("depth_maps", 1, "photometric")));
  EXPECT_THAT(FilesNamedLike("tmp"), testing::IsEmpty());
  EXPECT_THAT(FilesNamedLike("lock"), testing::IsEmpty());
}

TEST_F(ControllerTest, UnreadableImageFailsAloneAndIsNamed) {
  std::filesystem::resize_file(scene_.path() / "images" / ViewName(1), 60);
  const RunSummary summary = Run();
  EXPECT_THAT(summary.failed, testing::ElementsAre(ViewName(1)));
  EXPECT_EQ(summary.num_computed, kNumImages - 1);
  EXPECT_TRUE(std::filesystem::exists(MapPath("depth_maps", 0, "geometric")));
  EXPECT_FALSE(std::filesystem::exists(MapPath("depth_maps", 1, "geometric")));
  EXPECT_THAT(InnerFolders(), testing::IsEmpty());
}

TEST_F(ControllerTest, ASourceThatIsNoReferenceIsNoFailure) {
  WriteFile(scene_.path() / "stereo/patch-match.cfg",
            ViewName(0) + "\n__all__\n" + ViewName(2) + "\n__all__\n");
  std::filesystem::resize_file(scene_.path() / "images" / ViewName(1), 60);
  std::filesystem::remove(scene_.path() / "images" / ViewName(3));
  const RunSummary summary = Run();
  EXPECT_THAT(summary.failed, testing::IsEmpty());
  EXPECT_EQ(summary.num_computed, 2);
}

// What an interrupted run leaves goes when a later one has made everything.
TEST_F(ControllerTest, NoInnerMapsAreLeftOfAnyRun) {
  WriteFile(scene_.path() / "stereo/hpm_mvs/level_7_photometric/a.depth.bin",
            "of other options");
  Run();
  EXPECT_THAT(InnerFolders(), testing::IsEmpty());
}

TEST_F(ControllerTest, EveryMethodRuns) {
  options_.hpm.num_iterations = 1;
  options_.hpm.num_levels = 2;
  for (const std::string& method : MethodNames()) {
    options_.hpm.method = method;
    EXPECT_EQ(Run().num_computed, kNumImages) << method;
    EXPECT_EQ(Depth(0, "geometric").size(), kWidth * kHeight * 1u);
  }
}

}  // namespace
}  // namespace hpm
