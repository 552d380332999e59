// What a run keeps of those before it, and what it makes again.
#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "tests/colmap_plugin/controller/controller_fixture.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

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
                testing::ElementsAre(
                    testing::HasSubstr(ViewName(1)),
                    testing::AllOf(testing::HasSubstr("maps of an earlier run"),
                                   testing::HasSubstr(ViewName(1)))));
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

}  // namespace
}  // namespace hpm
