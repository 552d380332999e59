// Whole runs over a small workspace, in process.
#include "colmap_plugin/controller/controller.h"

#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/engine/schedule.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kNumImages = 4;
constexpr int kWidth = 40;
constexpr int kHeight = 30;

class ControllerTest : public testing::Test {
 protected:
  ControllerTest() {
    options_.workspace.path = scene_.path();
    options_.hpm.method = "nesp";
    options_.hpm.num_iterations = 2;
    options_.hpm.num_geom_iterations = 1;
    options_.patch_match.num_threads = 2;
    options_.patch_match.cache_size = 0.1;
  }

  RunSummary Run() {
    PatchMatchController controller(
        options_,
        [this](LogLevel level, const std::string& line) {
          if (level == LogLevel::kWarning) warnings_.push_back(line);
          if (on_line_) on_line_(line);
        },
        [this](const ProgressEvent& event) {
          events_.push_back(event);
          if (on_progress_) on_progress_(event);
        },
        cancel_);
    return controller.Run();
  }

  std::filesystem::path MapPath(const std::string& folder,
                                int image,
                                const std::string& stage) const {
    return scene_.path() / "stereo" / folder /
           (ViewName(image) + "." + stage + ".bin");
  }

  std::vector<float> Depth(int image, const std::string& stage) const {
    return ReadMap(MapPath("depth_maps", image, stage)).data;
  }

  std::vector<std::filesystem::path> FilesNamedLike(
      const std::string& part) const {
    std::vector<std::filesystem::path> found;
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(scene_.path())) {
      if (entry.path().filename().string().find(part) != std::string::npos) {
        found.push_back(entry.path());
      }
    }
    return found;
  }

  // Folders of maps between stages.
  std::vector<std::string> InnerFolders() const {
    std::vector<std::string> found;
    for (const auto& entry : std::filesystem::directory_iterator(
             scene_.path() / "stereo/hpm_mvs")) {
      if (entry.is_directory() && entry.path().filename() != "stamps")
        found.push_back(entry.path().filename().string());
    }
    return found;
  }

  SceneWorkspace scene_{SmallScene(kNumImages, kWidth, kHeight)};
  ControllerOptions options_;
  CancelToken cancel_;
  std::vector<ProgressEvent> events_;
  std::vector<std::string> warnings_;
  std::function<void(const ProgressEvent&)> on_progress_;
  std::function<void(const std::string&)> on_line_;
};

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

TEST_F(ControllerTest, SecondRunKeepsEverything) {
  Run();
  const std::vector<float> before = Depth(0, "geometric");
  events_.clear();
  const RunSummary second = Run();
  EXPECT_EQ(second.num_computed, 0);
  EXPECT_EQ(second.num_kept, kNumImages);
  EXPECT_EQ(Depth(0, "geometric"), before);
}

// Whatever was lost, the maps that come back are the same.
TEST_F(ControllerTest, ResumedRunGivesTheSameMaps) {
  Run();
  std::map<std::filesystem::path, std::vector<float>> before;
  for (int i = 0; i < kNumImages; ++i) {
    for (const char* stage : {"photometric", "geometric"}) {
      const auto path = MapPath("depth_maps", i, stage);
      before[path] = ReadMap(path).data;
    }
  }
  std::filesystem::remove(MapPath("depth_maps", 2, "geometric"));
  std::filesystem::remove(MapPath("normal_maps", 1, "photometric"));
  options_.patch_match.num_threads = 1;
  const RunSummary summary = Run();
  EXPECT_GE(summary.num_computed, 2);
  for (const auto& [path, data] : before) {
    EXPECT_EQ(ReadMap(path).data, data) << path;
  }
}

TEST_F(ControllerTest, OtherSeedComputesOtherMaps) {
  Run();
  const std::vector<float> before = Depth(0, "photometric");
  options_.random_seed = 1;
  EXPECT_EQ(Run().num_computed, kNumImages);
  EXPECT_NE(Depth(0, "photometric"), before);
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

// Damage that only decoding finds, at first in the middle of the run: the maps
// are those of a run without the image, the next run keeps them, and those
// after a repair are as if nothing had been. The size of the file says nothing.
TEST_F(ControllerTest, AnUnreadableImageIsPlannedWithoutAndComesBack) {
  Run();
  const std::vector<float> whole = Depth(0, "geometric");
  const std::filesystem::path file = scene_.path() / "images" / ViewName(1);
  const std::string good = ReadFile(file);
  WriteFile(file, good.substr(0, 60) + std::string(good.size() - 60, 'x'));
  for (const bool overwrite : {true, false, false}) {
    options_.hpm.overwrite = overwrite;
    warnings_.clear();
    const RunSummary summary = Run();
    EXPECT_THAT(summary.failed, testing::ElementsAre(ViewName(1)));
    EXPECT_EQ(summary.num_computed, overwrite ? kNumImages - 1 : 0);
    if (overwrite) {
      EXPECT_THAT(ReadFile(scene_.path() / "stereo/hpm_mvs/run.json"),
                  testing::HasSubstr("\"Hpm.overwrite\": true"));
    }
    EXPECT_THAT(InnerFolders(), testing::IsEmpty());
    // Nothing of maps of other options, and once.
    EXPECT_THAT(warnings_,
                testing::ElementsAre(testing::HasSubstr(ViewName(1))));
  }
  const std::vector<float> without = Depth(0, "geometric");
  EXPECT_NE(without, whole);
  WriteFile(file, good);
  EXPECT_THAT(Run().failed, testing::IsEmpty());
  EXPECT_EQ(Depth(0, "geometric"), whole);

  std::filesystem::remove(file);
  std::filesystem::remove_all(scene_.path() / "stereo/depth_maps");
  Run();
  EXPECT_EQ(Depth(0, "geometric"), without);
}

// The same where another image takes the place of the damaged one among the
// sources, and gets maps of its own that nobody asked for before.
TEST_F(ControllerTest, AnUnreadableSourceOfAFewReferencesIsReplaced) {
  const std::filesystem::path cfg = scene_.path() / "stereo/patch-match.cfg";
  WriteFile(cfg, ViewName(0) + "\n__auto__, 1\n");
  options_.hpm.num_geom_passes = 2;
  Run();
  const std::vector<float> whole = Depth(0, "geometric");
  int source = 0;
  std::string good;
  const auto file = [&] { return scene_.path() / "images" / ViewName(source); };
  // Which one it is shows when it is damaged.
  for (std::vector<float> without = whole; without == whole;) {
    if (source > 0) WriteFile(file(), good);
    ASSERT_LT(++source, kNumImages);
    good = ReadFile(file());
    WriteFile(file(), good.substr(0, 60) + std::string(good.size() - 60, 'x'));
    for (const bool overwrite : {true, false}) {
      options_.hpm.overwrite = overwrite;
      const RunSummary summary = Run();
      EXPECT_THAT(summary.failed, testing::IsEmpty());
      EXPECT_EQ(summary.num_problems, 1);
      EXPECT_EQ(summary.num_computed, overwrite ? 1 : 0);
      EXPECT_THAT(InnerFolders(), testing::IsEmpty());
    }
    without = Depth(0, "geometric");
  }
  const std::vector<float> without = Depth(0, "geometric");
  WriteFile(file(), good);
  EXPECT_EQ(Run().num_computed, 1);
  EXPECT_EQ(Depth(0, "geometric"), whole);

  std::filesystem::remove(file());
  EXPECT_EQ(Run().num_computed, 1);
  EXPECT_EQ(Depth(0, "geometric"), without);
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

// Half replaced maps must not pass for those of the run before.
TEST_F(ControllerTest, StampsGoBeforeTheirMapsAreReplaced) {
  Run();
  const std::filesystem::path state = scene_.path() / "stereo/hpm_mvs";
  ASSERT_TRUE(ReadStamp(state, ViewName(0), "photometric"));
  // A folder in its place: the depth map cannot be published.
  const std::filesystem::path depth = MapPath("depth_maps", 0, "photometric");
  std::filesystem::remove(depth);
  std::filesystem::create_directories(depth / "in_the_way");
  options_.random_seed = 7;
  try {
    Run();
  } catch (const Error&) {
  }
  EXPECT_FALSE(ReadStamp(state, ViewName(0), "photometric"));
}

TEST_F(ControllerTest, ResultsWithoutAFailedSourceAreMadeAgain) {
  Run();
  const std::vector<float> expected = Depth(0, "geometric");
  options_.hpm.overwrite = true;
  on_progress_ = [&](const ProgressEvent& event) {
    // After its own photometric stage, the maps of image 1 vanish.
    if (event.stage != "photometric" && !event.image.empty()) {
      std::filesystem::remove(MapPath("depth_maps", 1, "photometric"));
    }
  };
  Run();
  on_progress_ = nullptr;
  options_.hpm.overwrite = false;
  Run();
  EXPECT_EQ(Depth(0, "geometric"), expected);
}

// It is another when it is decoded than when the run was planned.
TEST_F(ControllerTest, ResultsOfAnImageThatChangedMeanwhileAreMadeAgain) {
  Run();
  const std::vector<float> expected = Depth(0, "geometric");
  options_.hpm.overwrite = true;
  const std::filesystem::path image = scene_.path() / "images" / ViewName(1);
  const std::string good = ReadFile(image);
  on_line_ = [&](const std::string& line) {
    if (line.find(" MB of memory") == std::string::npos) return;
    WriteFile(image, ReadFile(scene_.path() / "images" / ViewName(2)));
  };
  Run();
  EXPECT_NE(Depth(0, "geometric"), expected);
  EXPECT_THAT(warnings_,
              testing::Contains(testing::HasSubstr("changed during this run")));
  on_line_ = nullptr;
  options_.hpm.overwrite = false;
  WriteFile(image, good);
  Run();
  EXPECT_EQ(Depth(0, "geometric"), expected);
}

// Also where the gap lies several stages and a level before the end. Image 0
// has one source and is nobody's, so that it learns of the gap from itself
// alone.
TEST_F(ControllerTest, AGapIsRememberedThroughLevelsAndStages) {
  options_.hpm.method = "hpm_plus";
  options_.hpm.num_levels = 2;
  options_.hpm.num_geom_passes = 2;
  std::string cfg;
  for (const auto& [ref, src] : {std::pair(0, 1), {1, 2}, {2, 3}, {3, 2}}) {
    cfg += ViewName(ref) + "\n" + ViewName(src) + "\n";
  }
  WriteFile(scene_.path() / "stereo/patch-match.cfg", cfg);
  Run();
  const std::vector<float> expected = Depth(0, "geometric");
  options_.hpm.overwrite = true;
  // The maps of image 1 are away while image 0 wants to read them.
  const std::filesystem::path map = scene_.path() / "stereo/hpm_mvs" /
                                    "level_1_geometric_1" /
                                    (ViewName(1) + ".depth.bin");
  const std::filesystem::path away = scene_.path() / "away.bin";
  on_progress_ = [&](const ProgressEvent& event) {
    if (event.stage == "level_1_geometric_1" &&
        event.image == ViewName(kNumImages - 1) &&
        std::filesystem::exists(map)) {
      std::filesystem::rename(map, away);
    } else if (event.stage == "level_1_geometric_2" &&
               event.image == ViewName(0) && std::filesystem::exists(away)) {
      std::filesystem::rename(away, map);
    }
  };
  Run();
  EXPECT_NE(Depth(0, "geometric"), expected);
  on_progress_ = nullptr;
  options_.hpm.overwrite = false;
  Run();
  EXPECT_EQ(Depth(0, "geometric"), expected);
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
