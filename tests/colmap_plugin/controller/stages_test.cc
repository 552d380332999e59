// Which maps a plan wants computed, and where they go.
#include "colmap_plugin/controller/stages.h"

#include "tests/colmap_plugin/controller/stage_plan_fixture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

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
