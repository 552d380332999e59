// Which maps of earlier runs a plan takes for its own.
#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/workspace/file_system.h"
#include "src/base/error.h"
#include "src/base/platform/processes.h"
#include "tests/colmap_plugin/controller/stage_plan_fixture.h"

#include <chrono>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

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
  EXPECT_EQ(ChangedBy([&] { hpm.weak_gradient = 0; }), all);
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

}  // namespace
}  // namespace hpm
