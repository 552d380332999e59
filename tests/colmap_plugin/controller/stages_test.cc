#include "colmap_plugin/controller/stages.h"

#include "colmap_plugin/formats/consistency_graph.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/options/method_options.h"
#include "colmap_plugin/workspace/file_system.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/base/platform/processes.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <chrono>
#include <fstream>
#include <functional>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr int kWidth = 12;
constexpr int kHeight = 9;

// Five images in a row, each with its neighbours as sources; photometric and
// three geometric stages.
class StagePlanTest : public testing::Test {
 protected:
  StagePlanTest() {
    options_.hpm.method = "nesp";
    options_.hpm.num_levels = 1;
    options_.hpm.num_geom_passes = 3;
    for (int i = 0; i < 5; ++i) {
      StereoProblem problem;
      problem.ref_image = i;
      if (i > 0) problem.src_images.push_back(i - 1);
      if (i < 4) problem.src_images.push_back(i + 1);
      problem.depth_min = 3;
      problem.depth_max = 8;
      problems_.push_back(problem);
    }
  }

  StagePlan Plan() {
    return StagePlan(workspace_,
                     problems_,
                     MakeSchedule(MakeScheduleOptions(options_)),
                     options_,
                     &contents_,
                     cancel_);
  }

  // The problems to compute in a stage.
  std::vector<int> Needed(const StagePlan& plan, int stage) const {
    std::vector<int> needed;
    for (int p = 0; p < static_cast<int>(problems_.size()); ++p) {
      if (plan.IsNeeded(stage, p)) needed.push_back(p);
    }
    return needed;
  }

  void Finish(const StagePlan& plan, int stage, int problem) {
    const StageFiles files = plan.Files(stage, problems_[problem].ref_image);
    for (const auto& path : {files.depth, files.normal}) {
      std::filesystem::create_directories(path.parent_path());
    }
    Stamp stamp = {plan.FingerprintOf(stage, problem), {}, nullptr, {}};
    std::vector<float> data(kWidth * kHeight, 1.0f);
    stamp.files["depth"] = WriteMap(files.depth, {kWidth, kHeight, 1, data});
    data.resize(3 * data.size(), 0.5f);
    stamp.files["normal"] = WriteMap(files.normal, {kWidth, kHeight, 3, data});
    if (options_.patch_match.write_consistency_graph) {
      stamp.files["graph"] =
          WriteConsistencyGraph(files.graph, {kWidth, kHeight, {}});
    }
    const std::string& stage_name = plan.stages()[stage].name;
    const std::string& name =
        workspace_.ImageName(problems_[problem].ref_image);
    WriteStamp(workspace_.StatePath(), name, stage_name, stamp);
  }

  void FinishAll(bool inner) {
    const StagePlan plan = Plan();
    for (int s = 0; s < static_cast<int>(plan.stages().size()); ++s) {
      if (!inner && !plan.stages()[s].is_public) continue;
      for (int p = 0; p < 5; ++p) Finish(plan, s, p);
    }
  }

  std::filesystem::path DepthFile(int stage, int problem) {
    return Plan().Files(stage, problem).depth;
  }

  // Stages in which the fingerprint of problem 2 changes with the options.
  std::set<int> ChangedBy(const std::function<void()>& change) {
    const ControllerOptions options = options_;
    const std::vector<StereoProblem> problems = problems_;
    const StagePlan before = Plan();
    std::vector<std::string> old;
    for (int s = 0; s < 4; ++s) old.push_back(before.FingerprintOf(s, 2));
    change();
    const StagePlan after = Plan();
    std::set<int> changed;
    for (int s = 0; s < 4; ++s) {
      if (after.FingerprintOf(s, 2) != old[s]) changed.insert(s);
    }
    options_ = options;
    problems_ = problems;
    return changed;
  }

  SceneWorkspace scene_{SmallScene(5, kWidth, kHeight)};
  Workspace workspace_ = scene_.Open();
  ImageContents contents_{workspace_};
  CancelToken cancel_;
  ControllerOptions options_;
  std::vector<StereoProblem> problems_;
};

TEST_F(StagePlanTest, StagesHaveColmapsNamesAtBothEnds) {
  const StagePlan plan = Plan();
  ASSERT_EQ(plan.stages().size(), 4u);
  EXPECT_EQ(plan.stages()[0].name, "photometric");
  EXPECT_EQ(plan.stages()[1].name, "geometric_1");
  EXPECT_EQ(plan.stages()[2].name, "geometric_2");
  EXPECT_EQ(plan.stages()[3].name, "geometric");
  EXPECT_TRUE(plan.stages()[3].is_final);
  EXPECT_EQ(
      plan.Files(3, 1).depth,
      scene_.path() / "stereo/depth_maps" / (ViewName(1) + ".geometric.bin"));
  EXPECT_EQ(plan.Files(0, 1).normal,
            scene_.path() / "stereo/normal_maps" /
                (ViewName(1) + ".photometric.bin"));
  // Inner maps stay out of COLMAP's folders.
  EXPECT_THAT(plan.Files(1, 1).depth.string(),
              testing::StartsWith(workspace_.StatePath().string()));
}

TEST_F(StagePlanTest, WithoutGeometricConsistencyPhotometricIsFinal) {
  options_.patch_match.geom_consistency = false;
  const StagePlan plan = Plan();
  ASSERT_EQ(plan.stages().size(), 1u);
  EXPECT_EQ(plan.stages()[0].name, "photometric");
  EXPECT_TRUE(plan.stages()[0].is_final);
}

TEST_F(StagePlanTest, EverythingIsNeededInAFreshWorkspace) {
  const StagePlan plan = Plan();
  for (int s = 0; s < 4; ++s) {
    EXPECT_THAT(Needed(plan, s), ElementsAre(0, 1, 2, 3, 4));
  }
  EXPECT_FALSE(plan.ReplacesForeignMaps());
}

TEST_F(StagePlanTest, NothingIsNeededWhenThePublicMapsAreComplete) {
  FinishAll(false);
  const StagePlan plan = Plan();
  for (int s = 0; s < 4; ++s) EXPECT_THAT(Needed(plan, s), IsEmpty());
  EXPECT_FALSE(plan.ReplacesForeignMaps());
}

// The final map of image 0 needs geometric_2 of 0 and its source 1, these need
// geometric_1 of 0, 1 and 2.
TEST_F(StagePlanTest, LostFinalMapNeedsInnerMapsOfItsSourcesBackward) {
  FinishAll(false);
  std::filesystem::remove(DepthFile(3, 0));
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 3), ElementsAre(0));
  EXPECT_THAT(Needed(plan, 2), ElementsAre(0, 1));
  EXPECT_THAT(Needed(plan, 1), ElementsAre(0, 1, 2));
  EXPECT_THAT(Needed(plan, 0), IsEmpty());
}

TEST_F(StagePlanTest, InnerMapsThatAreThereAreUsed) {
  FinishAll(true);
  std::filesystem::remove(DepthFile(3, 0));
  std::filesystem::remove(DepthFile(2, 1));
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 3), ElementsAre(0));
  EXPECT_THAT(Needed(plan, 2), ElementsAre(1));
  EXPECT_THAT(Needed(plan, 1), IsEmpty());
  EXPECT_THAT(Needed(plan, 0), IsEmpty());
}

TEST_F(StagePlanTest, LostInnerMapsAreNotMissedOnceTheResultIsThere) {
  FinishAll(true);
  std::filesystem::remove_all(workspace_.StatePath() / "geometric_1");
  for (int s = 0; s < 4; ++s) EXPECT_THAT(Needed(Plan(), s), IsEmpty());
}

TEST_F(StagePlanTest, LostPhotometricMapIsComputedAgainAlone) {
  FinishAll(false);
  std::filesystem::remove(DepthFile(0, 2));
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 0), ElementsAre(2));
  for (int s = 1; s < 4; ++s) EXPECT_THAT(Needed(plan, s), IsEmpty());
}

// An interrupted run: photometric done but for image 3.
TEST_F(StagePlanTest, ResumeComputesWhatIsMissing) {
  const StagePlan fresh = Plan();
  for (const int p : {0, 1, 2, 4}) Finish(fresh, 0, p);
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 0), ElementsAre(3));
  for (int s = 1; s < 4; ++s) {
    EXPECT_THAT(Needed(plan, s), ElementsAre(0, 1, 2, 3, 4));
  }
}

TEST_F(StagePlanTest, DamagedMapsAreComputedAgain) {
  FinishAll(false);
  const StagePlan before = Plan();
  std::filesystem::resize_file(before.Files(3, 0).depth, 40);  // cut
  std::filesystem::remove(before.Files(3, 1).normal);
  std::ofstream(before.Files(3, 2).normal) << "no map";
  WriteMap(before.Files(3, 3).depth, {2, 2, 1, {1, 1, 1, 1}});  // other size
  // The channels of a normal map.
  WriteMap(before.Files(3, 4).depth,
           {kWidth, kHeight, 3, std::vector<float>(3 * kWidth * kHeight, 1)});
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 3), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_FALSE(plan.ReplacesForeignMaps());
}

// The stamp goes, so that nobody uses the map where it cannot be made again.
TEST_F(StagePlanTest, AMapWithOtherContentsIsNobodysInput) {
  FinishAll(false);
  const std::filesystem::path depth = DepthFile(0, 2);
  const auto time = std::filesystem::last_write_time(depth);
  std::vector<float> data(kWidth * kHeight, 1.0f);
  data.back() = 2;
  WriteMap(depth, {kWidth, kHeight, 1, data});
  std::filesystem::last_write_time(depth, time + std::chrono::nanoseconds(1));
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 0), ElementsAre(2));
  EXPECT_THAT(Needed(plan, 3), IsEmpty());
  EXPECT_THAT(plan.damaged_maps(), ElementsAre(depth));
  EXPECT_FALSE(plan.ReplacesForeignMaps());
  EXPECT_FALSE(plan.HasCurrentMaps(0, 2));
  EXPECT_TRUE(plan.HasCurrentMaps(0, 1));
}

TEST_F(StagePlanTest, IncompleteMapsAreCheckedToo) {
  FinishAll(false);
  const StagePlan before = Plan();
  for (const int p : {1, 2}) {
    const std::string& name = workspace_.ImageName(p);
    std::optional<Stamp> stamp =
        ReadStamp(workspace_.StatePath(), name, "photometric");
    ASSERT_TRUE(stamp);
    stamp->fingerprint = before.IncompleteFingerprintOf(0, p);
    WriteStamp(workspace_.StatePath(), name, "photometric", *stamp);
  }
  std::filesystem::resize_file(DepthFile(0, 2), 40);
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 0), ElementsAre(1, 2));
  EXPECT_TRUE(plan.HasCurrentMaps(0, 1));
  EXPECT_FALSE(plan.HasCurrentMaps(0, 2));
}

TEST_F(StagePlanTest, TouchedMapsAreKeptAndStampedWithTheirNewTime) {
  FinishAll(false);
  const std::filesystem::path depth = DepthFile(3, 2);
  std::filesystem::last_write_time(
      depth, std::filesystem::last_write_time(depth) + std::chrono::hours(1));
  for (int s = 0; s < 4; ++s) EXPECT_THAT(Needed(Plan(), s), IsEmpty());
  const std::optional<Stamp> stamp =
      ReadStamp(workspace_.StatePath(), workspace_.ImageName(2), "geometric");
  ASSERT_TRUE(stamp);
  EXPECT_EQ(stamp->files.at("depth").state, StateOf(depth));
  // Whoever made the copy did not sync it.
  EXPECT_EQ(stamp->unsynced_since, UnsyncedSince(workspace_.StatePath()));
}

// Inner maps are not synced to the disk: after a power cut a file of the right
// length and time may hold anything.
TEST_F(StagePlanTest, UnsyncedMapsAreReadAfterTheMachineWasStartedAnew) {
  for (const auto& [boot, is_believed] :
       {std::pair<std::string, bool>{BootId(), !BootId().empty()},
        {"another", false},
        {"", false}}) {
    FinishAll(false);
    const std::filesystem::path depth = DepthFile(0, 2);
    const std::string& name = workspace_.ImageName(2);
    std::optional<Stamp> stamp =
        ReadStamp(workspace_.StatePath(), name, "photometric");
    ASSERT_TRUE(stamp);
    stamp->unsynced_since = boot;
    WriteStamp(workspace_.StatePath(), name, "photometric", *stamp);
    EXPECT_THAT(Needed(Plan(), 0), IsEmpty());
    // On a local disk they are compared once after each start.
    EXPECT_EQ(
        ReadStamp(workspace_.StatePath(), name, "photometric")->unsynced_since,
        boot == "another" ? UnsyncedSince(workspace_.StatePath()) : boot);
    WriteStamp(workspace_.StatePath(), name, "photometric", *stamp);

    const auto time = std::filesystem::last_write_time(depth);
    std::string bytes = ReadFile(depth);
    bytes.replace(bytes.size() - 8, 8, 8, '\0');
    WriteFile(depth, bytes);
    std::filesystem::last_write_time(depth, time);
    EXPECT_EQ(Needed(Plan(), 0).empty(), is_believed) << boot;
  }
}

TEST_F(StagePlanTest, ComparingMapsHearsCancel) {
  FinishAll(false);
  for (int p = 0; p < 5; ++p)
    std::filesystem::last_write_time(DepthFile(0, p), {});
  cancel_.Cancel();
  EXPECT_THROW(Plan(), Error);
}

TEST_F(StagePlanTest, AnImageThatBecameAnotherOfTheSameLengthChangesAll) {
  const std::filesystem::path path = workspace_.ImagePath(2);
  EXPECT_EQ(ChangedBy([&] {
              std::string bytes = ReadFile(path);
              bytes.back() = static_cast<char>(bytes.back() + 1);
              WriteFile(path, bytes);
              contents_ = ImageContents(workspace_);
            }),
            (std::set<int>{0, 1, 2, 3}));
  EXPECT_TRUE(Plan().HasSameImages(2));
  EXPECT_TRUE(Plan().HasSameImages(4));
  WriteFile(path, "x");
  EXPECT_FALSE(Plan().HasSameImages(2));
  EXPECT_FALSE(Plan().HasSameImages(1));  // a source
  EXPECT_TRUE(Plan().HasSameImages(4));
}

TEST_F(StagePlanTest, MapsWithoutTheirStampAreForeign) {
  FinishAll(false);
  std::filesystem::remove_all(workspace_.StatePath() / "stamps");
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 0), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(Needed(plan, 3), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_TRUE(plan.ReplacesForeignMaps());
}

TEST_F(StagePlanTest, MapsMadeWithOtherOptionsAreForeign) {
  FinishAll(false);
  options_.random_seed = 1;
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 0), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_TRUE(plan.ReplacesForeignMaps());
}

TEST_F(StagePlanTest, FilterOptionsConcernTheFinalStageOnly) {
  FinishAll(false);
  options_.patch_match.filter_min_ncc = 0.2;
  const StagePlan plan = Plan();
  EXPECT_THAT(Needed(plan, 3), ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(Needed(plan, 0), IsEmpty());
}

TEST_F(StagePlanTest, EachOptionChangesTheFingerprintsItConcerns) {
  using Changed = std::set<int>;
  const Changed all = {0, 1, 2, 3}, geometric = {1, 2, 3}, final = {3};
  auto& hpm = options_.hpm;
  auto& colmap = options_.patch_match;
  EXPECT_EQ(ChangedBy([&] {}), Changed());
  EXPECT_EQ(ChangedBy([&] { hpm.method = "acmh"; }), all);
  EXPECT_EQ(ChangedBy([&] { hpm.num_iterations = 7; }), all);
  EXPECT_EQ(ChangedBy([&] { hpm.num_geom_iterations = 7; }), geometric);
  EXPECT_EQ(ChangedBy([&] { hpm.geom_weight = 0.2; }), geometric);
  EXPECT_EQ(ChangedBy([&] { hpm.geom_max_error = 3; }), geometric);
  EXPECT_EQ(ChangedBy([&] { hpm.max_views = 3; }), all);
  EXPECT_EQ(ChangedBy([&] { hpm.weak_gradient = 0; }), geometric);
  EXPECT_EQ(ChangedBy([&] { options_.random_seed = 5; }), all);
  EXPECT_EQ(ChangedBy([&] { colmap.window_radius = 4; }), all);
  EXPECT_EQ(ChangedBy([&] { colmap.sigma_spatial = 4; }), all);
  EXPECT_EQ(ChangedBy([&] { colmap.num_samples = 30; }), all);
  EXPECT_EQ(ChangedBy([&] { colmap.filter = false; }), final);
  EXPECT_EQ(ChangedBy([&] { hpm.filter_min_agreement = 0; }), final);
  EXPECT_EQ(ChangedBy([&] { colmap.filter_min_num_consistent = 1; }), final);
  EXPECT_EQ(ChangedBy([&] { colmap.filter_min_triangulation_angle = 1; }),
            final);
  EXPECT_EQ(ChangedBy([&] { colmap.filter_geom_consistency_max_cost = 2; }),
            final);
  EXPECT_EQ(ChangedBy([&] { problems_[2].depth_max = 9; }), all);
  EXPECT_EQ(ChangedBy([&] { problems_[2].src_images = {1}; }), all);
  // Of a source, and of a source's source: they come in with the depth maps.
  EXPECT_EQ(ChangedBy([&] { problems_[1].depth_max = 9; }), geometric);
  EXPECT_EQ(ChangedBy([&] { problems_[0].depth_max = 9; }), (Changed{2, 3}));
  // What cannot change a map.
  EXPECT_EQ(ChangedBy([&] { colmap.num_threads = 7; }), Changed());
  EXPECT_EQ(ChangedBy([&] { colmap.cache_size = 1; }), Changed());
  EXPECT_EQ(ChangedBy([&] { hpm.previews = true; }), Changed());
  EXPECT_EQ(ChangedBy([&] {
              std::ofstream(workspace_.ImagePath(2), std::ios::app) << "x";
              contents_ = ImageContents(workspace_);
            }),
            all);
}

TEST_F(StagePlanTest, OverwriteNeedsEverything) {
  FinishAll(true);
  options_.hpm.overwrite = true;
  for (int s = 0; s < 4; ++s) {
    EXPECT_THAT(Needed(Plan(), s), ElementsAre(0, 1, 2, 3, 4));
  }
}

TEST_F(StagePlanTest, MissingConsistencyGraphsAreMadeWhenAskedFor) {
  FinishAll(false);
  options_.patch_match.write_consistency_graph = true;
  EXPECT_THAT(Needed(Plan(), 3), ElementsAre(0, 1, 2, 3, 4));
  const StagePlan plan = Plan();
  EXPECT_TRUE(plan.WritesGraph(0, 0));
  EXPECT_TRUE(plan.WritesGraph(3, 0));
  EXPECT_FALSE(plan.WritesGraph(1, 0));
  FinishAll(false);
  EXPECT_THAT(Needed(Plan(), 3), IsEmpty());
}

// The run has forgotten the maps of others by then.
TEST_F(StagePlanTest, AnUpdateOfAnOverwritingPlanKeepsWhatTheRunMade) {
  options_.hpm.overwrite = true;
  StagePlan plan = Plan();
  for (int s = 0; s < 4; ++s) Finish(plan, s, 2);
  plan.Update();
  EXPECT_THAT(Needed(plan, 3), ElementsAre(0, 1, 3, 4));
}

// Images 1 and 2 are there for the reference 0 alone: image 0 reads maps of 1
// before its last stage, image 1 those of 2 before that.
TEST_F(StagePlanTest, MapsOfSourcesAreMadeAsFarAsOthersReadThem) {
  problems_.resize(3);
  problems_[1].is_reference = problems_[2].is_reference = false;
  const StagePlan plan = Plan();
  const auto needed = [&](int stage) {
    std::vector<int> images;
    for (int p = 0; p < 3; ++p) {
      if (plan.IsNeeded(stage, p)) images.push_back(p);
    }
    return images;
  };
  EXPECT_THAT(needed(3), ElementsAre(0));
  EXPECT_THAT(needed(2), ElementsAre(0, 1));
  EXPECT_THAT(needed(1), ElementsAre(0, 1, 2));
  EXPECT_THAT(needed(0), ElementsAre(0, 1, 2));
}

// An image may be a reference in another run: neither takes the other's maps
// for its own.
TEST_F(StagePlanTest, MapsOfSourcesAreNotPublished) {
  FinishAll(false);
  const std::filesystem::path depth = DepthFile(0, 1);
  problems_[1].is_reference = false;
  options_.patch_match.write_consistency_graph = true;
  const StagePlan plan = Plan();
  EXPECT_FALSE(plan.IsPublic(0, 1));
  EXPECT_TRUE(plan.IsPublic(0, 0));
  EXPECT_FALSE(plan.WritesGraph(0, 1));
  EXPECT_NE(plan.Files(0, 1).depth, depth);
  EXPECT_THAT(plan.Files(0, 1).depth.string(),
              testing::StartsWith(workspace_.StatePath().string()));
  EXPECT_NE(plan.NameOf(0, 1), plan.NameOf(0, 0));
  EXPECT_FALSE(plan.HasCompleteMaps(0, 1));
}

// The result does not depend on who else is a reference.
TEST_F(StagePlanTest, AReferenceIsFinishedWhateverItsSourcesAre) {
  FinishAll(false);
  for (const int p : {1, 2, 3, 4}) problems_[p].is_reference = false;
  for (int s = 0; s < 4; ++s) EXPECT_THAT(Needed(Plan(), s), IsEmpty());
}

// A source without a problem has no maps; nothing waits for it.
TEST_F(StagePlanTest, SourcesWithoutAProblemAreNotComputed) {
  problems_.resize(2);
  const StagePlan plan = Plan();
  for (int s = 0; s < 4; ++s) EXPECT_THAT(Needed(plan, s), ElementsAre(0, 1));
}

}  // namespace
}  // namespace hpm
