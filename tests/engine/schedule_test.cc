#include "src/engine/schedule.h"

#include "src/base/error.h"

#include <cstdlib>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

ScheduleOptions Options(const std::string& method, int num_levels = 3) {
  ScheduleOptions options;
  options.method = method;
  options.num_iterations = 4;
  options.num_geom_iterations = 2;
  options.num_geom_passes = 2;
  options.num_levels = num_levels;
  return options;
}

class EveryMethod : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Methods,
                         EveryMethod,
                         testing::ValuesIn(MethodNames()),
                         [](const auto& test) { return test.param; });

// Else two passes would draw the same random numbers.
TEST_P(EveryMethod, PassesHaveDistinctIds) {
  std::set<int> ids;
  size_t num_passes = 0;
  for (const StageSpec& stage : MakeSchedule(Options(GetParam())).stages) {
    for (const Pass& pass : stage.passes) ids.insert(pass.id);
    num_passes += stage.passes.size();
  }
  EXPECT_EQ(ids.size(), num_passes);
}

TEST_P(EveryMethod, StartsRandomOnceAndEndsAtFullSize) {
  const Schedule schedule = MakeSchedule(Options(GetParam()));
  int num_random = 0;
  for (const StageSpec& stage : schedule.stages) {
    for (const Pass& pass : stage.passes) {
      num_random += pass.start == StartFrom::kRandom;
    }
  }
  EXPECT_EQ(num_random, 1);
  EXPECT_EQ(schedule.stages[0].passes[0].start, StartFrom::kRandom);
  EXPECT_FALSE(schedule.stages[0].from_coarser);
  EXPECT_EQ(schedule.stages.back().level, 0);
}

TEST_P(EveryMethod, GeometricStagesFollowAStageOfTheirLevel) {
  const Schedule schedule = MakeSchedule(Options(GetParam()));
  for (size_t s = 0; s < schedule.stages.size(); ++s) {
    const StageSpec& stage = schedule.stages[s];
    for (const Pass& pass : stage.passes) {
      EXPECT_EQ(pass.kind == PassKind::kGeometric, stage.geometric);
      if (stage.geometric) {
        EXPECT_EQ(pass.num_iterations, 2);
      }
      EXPECT_EQ(pass.kind == PassKind::kPrior, pass.start == StartFrom::kPrior);
    }
    if (s == 0) {
      EXPECT_FALSE(stage.geometric);
    } else if (stage.from_coarser) {
      EXPECT_EQ(stage.level, schedule.stages[s - 1].level - 1);
    } else {
      EXPECT_TRUE(stage.geometric);
      EXPECT_EQ(stage.level, schedule.stages[s - 1].level);
    }
  }
}

TEST_P(EveryMethod, WithoutGeometricPassesThereAreNoGeometricStages) {
  ScheduleOptions options = Options(GetParam());
  options.num_geom_passes = 0;
  for (const StageSpec& stage : MakeSchedule(options).stages) {
    EXPECT_FALSE(stage.geometric);
  }
}

// Levels of the prior passes at full size, in order.
std::vector<int> PriorLevels(const std::string& method, int num_levels) {
  std::vector<int> levels;
  ScheduleOptions options = Options(method, num_levels);
  const StageSpec first = MakeSchedule(options).stages[0];
  for (const Pass& pass : first.passes) {
    if (pass.kind == PassKind::kPrior) levels.push_back(pass.level);
  }
  return levels;
}

TEST(Schedule, HpmBuildsPriorsFromCoarseToFine) {
  EXPECT_THAT(PriorLevels("hpm", 3), testing::ElementsAre(2, 1, 0));
  EXPECT_THAT(PriorLevels("hpm", 1), testing::ElementsAre(0));
}

TEST(Schedule, HpmFastBuildsTheCoarsestPriorOnly) {
  EXPECT_THAT(PriorLevels("hpm_fast", 3), testing::ElementsAre(2));
  EXPECT_THAT(PriorLevels("hpm_fast", 1), testing::ElementsAre(0));
}

// So that a researcher gets what he asks for by name.
TEST_P(EveryMethod, OnlyOursDepartsFromThePaper) {
  const Method& method = FindMethod(GetParam());
  const bool ours = std::string(method.name) == "hpm_plus";
  EXPECT_EQ(DefaultParams(method).cut_color > 0, ours);
  EXPECT_EQ(DefaultParams(method).same_plane_bound > 0, ours);
  EXPECT_EQ(DefaultParams(method).worst_cost < kMaxCost, ours);
  EXPECT_EQ(DefaultParams(method).max_views < kMaxViews, ours);
  for (const StageSpec& stage : MakeSchedule(Options(GetParam())).stages) {
    for (const Pass& pass : stage.passes) {
      EXPECT_EQ(pass.ask_all_views, !ours);
      EXPECT_EQ(pass.regions != RegionPriors::kNone, ours && stage.geometric);
      EXPECT_EQ(pass.search_near, ours && stage.geometric);
      EXPECT_EQ(pass.few_views, ours && stage.geometric);
      EXPECT_EQ(pass.propagate_views, ours && stage.geometric);
      EXPECT_EQ(pass.max_candidates < kNumRegions, ours && stage.geometric);
      EXPECT_TRUE(ours || !pass.triangles);
      EXPECT_EQ(pass.rest_plain, ours && pass.start == StartFrom::kRandom);
      EXPECT_TRUE(ours || !(pass.half_visits || pass.fit_planes));
    }
  }
}

TEST(Schedule, ThePapersNumbersAreTheDefault) {
  ScheduleOptions options;
  options.method = "hpm";
  const Schedule schedule = MakeSchedule(options);
  ASSERT_EQ(schedule.stages.size(), 3u);
  ASSERT_EQ(schedule.stages[0].passes.size(), 2u);
  for (const StageSpec& stage : schedule.stages) {
    EXPECT_EQ(stage.level, 0);
    for (const Pass& pass : stage.passes) EXPECT_EQ(pass.num_iterations, 3);
  }
}

TEST(Schedule, RegionsAreMinedOnImagesOfEveryLevel) {
  std::vector<int> levels;
  ScheduleOptions options = Options("hpm_plus");
  options.num_fine_geom_passes = 1;
  for (const StageSpec& stage : MakeSchedule(options).stages) {
    levels.push_back(stage.level);
    EXPECT_EQ(stage.from_coarser, !stage.geometric && stage.level < 2);
  }
  EXPECT_THAT(levels, testing::ElementsAre(2, 2, 2, 1, 1, 0, 0));
}

TEST(Schedule, FinerLevelsHaveNumbersOfTheirOwn) {
  ScheduleOptions options = Options("hpm_plus", 2);
  options.num_fine_geom_passes = 3;
  const auto fine_stage = [&options] {
    const Schedule schedule = MakeSchedule(options);
    EXPECT_EQ(schedule.stages.size(), 3u + 1 + 3);
    EXPECT_EQ(schedule.stages[0].passes[0].num_iterations, 4);
    return schedule.stages[3];
  };
  options.num_fine_iterations = 0;
  EXPECT_THAT(fine_stage().passes, testing::IsEmpty());
  options.num_fine_iterations = 2;
  ASSERT_EQ(fine_stage().passes.size(), 1u);
  EXPECT_EQ(fine_stage().passes[0].num_iterations, 2);
  // What came up keeps the cost it has been given.
  EXPECT_EQ(fine_stage().passes[0].start, StartFrom::kMissing);
}

TEST(Schedule, WithoutGeometricPassesFinerLevelsMatch) {
  ScheduleOptions options = Options("hpm_plus", 2);
  options.num_geom_passes = 0;
  options.num_fine_iterations = 0;
  const Schedule schedule = MakeSchedule(options);
  ASSERT_EQ(schedule.stages.size(), 2u);
  ASSERT_EQ(schedule.stages[1].passes.size(), 1u);
  EXPECT_EQ(schedule.stages[1].passes[0].num_iterations, 1);
  EXPECT_FALSE(schedule.stages[1].passes[0].half_visits);
}

TEST(Schedule, WithoutGeometricPassesFinerLevelsVisitAllPixelsHalfAsOften) {
  ScheduleOptions options = Options("hpm_plus", 2);
  options.num_geom_passes = 0;
  options.num_fine_iterations = 5;
  const Pass pass = MakeSchedule(options).stages[1].passes.at(0);
  EXPECT_FALSE(pass.half_visits);
  EXPECT_EQ(pass.num_iterations, 3);
}

// Else nothing would be there to be filtered.
TEST_P(EveryMethod, TheLastStageMatches) {
  ScheduleOptions options = Options(GetParam());
  for (const int num_geom_passes : {0, 1}) {
    options.num_geom_passes = num_geom_passes;
    options.num_iterations = 0;
    options.num_fine_iterations = 0;
    options.num_fine_geom_passes = 0;
    const Schedule schedule = MakeSchedule(options);
    EXPECT_FALSE(schedule.stages.back().passes.empty());
  }
}

TEST(Schedule, OnlyTheVeryLastPassIsStrongAndFitsPlanes) {
  const Schedule schedule = MakeSchedule(Options("hpm_plus"));
  for (const StageSpec& stage : schedule.stages) {
    for (const Pass& pass : stage.passes) {
      const bool last = &stage == &schedule.stages.back();
      EXPECT_EQ(pass.regions == RegionPriors::kStrong, last);
      EXPECT_EQ(pass.fit_planes, last);
    }
  }
}

TEST(Schedule, OnlyTheLastGeometricPassOfALevelVisitsAllPixels) {
  const Schedule schedule = MakeSchedule(Options("hpm_plus"));
  for (size_t s = 0; s < schedule.stages.size(); ++s) {
    const StageSpec& stage = schedule.stages[s];
    if (!stage.geometric) continue;
    const bool last = s + 1 == schedule.stages.size() ||
                      schedule.stages[s + 1].level < stage.level;
    EXPECT_EQ(stage.passes.back().half_visits, !last) << s;
  }
}

// A later pass could contradict them no more.
TEST(Schedule, TrianglesAreOfferedInTheFirstGeometricPassOnly) {
  for (const int num_levels : {1, 3}) {
    ScheduleOptions options = Options("hpm_plus", num_levels);
    options.num_geom_passes = 3;
    options.num_fine_geom_passes = 2;
    const Schedule schedule = MakeSchedule(options);
    for (size_t s = 0; s < schedule.stages.size(); ++s)
      EXPECT_EQ(schedule.stages[s].passes.back().triangles, s == 1) << s;
    options.num_geom_passes = 1;
    for (const StageSpec& stage : MakeSchedule(options).stages)
      EXPECT_FALSE(stage.passes.back().triangles);
  }
}

// What a pixel in between needs it takes from those beside it.
TEST(Schedule, TheSearchOfAFinerLevelVisitsHalfOfThePixels) {
  for (const StageSpec& stage : MakeSchedule(Options("hpm_plus", 3)).stages) {
    if (stage.geometric) continue;
    ASSERT_EQ(stage.passes.size(), 1u);
    EXPECT_EQ(stage.passes[0].half_visits, stage.level < 2) << stage.level;
  }
}

TEST(Schedule, NespHasNoPriors) {
  EXPECT_THAT(PriorLevels("nesp", 3), testing::IsEmpty());
}

// Sampling of the paper's ablation rows: N = nothing near, E = growing regions.
TEST(Schedule, AblationRowsSwitchTheSamplingPattern) {
  const auto near = [](const std::string& method) {
    const SamplingPattern p = MakeSchedule(Options(method)).pattern;
    return std::abs(p.dcol[0][0]) + std::abs(p.drow[0][0]) < 5;
  };
  const auto grows = [](const std::string& method) {
    return MakeSchedule(Options(method)).pattern.max_extensions > 0;
  };
  EXPECT_TRUE(near("acmh") && !grows("acmh"));
  EXPECT_TRUE(!near("nsp") && !grows("nsp"));
  EXPECT_TRUE(near("esp") && grows("esp"));
  EXPECT_TRUE(!near("nesp") && grows("nesp"));
  EXPECT_TRUE(!near("hpm") && grows("hpm"));
  EXPECT_TRUE(!near("hpm_plus") && grows("hpm_plus"));
  EXPECT_TRUE(near("hpm_no_nesp") && !grows("hpm_no_nesp"));
}

TEST(Schedule, UnknownMethodIsAnErrorThatListsTheMethods) {
  try {
    MakeSchedule(Options("sgm"));
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_THAT(error.what(), testing::HasSubstr("sgm"));
    for (const std::string& name : MethodNames()) {
      EXPECT_THAT(error.what(), testing::HasSubstr(name));
    }
  }
}

TEST(AutomaticLevels, FollowTheLongerSide) {
  const Method& paper = FindMethod("hpm");
  EXPECT_EQ(AutomaticLevels(paper, 1), 1);
  EXPECT_EQ(AutomaticLevels(paper, 1000), 1);
  EXPECT_EQ(AutomaticLevels(paper, 1920), 2);
  EXPECT_EQ(AutomaticLevels(paper, 3200), 3);
  const Method& plus = FindMethod("hpm_plus");
  EXPECT_EQ(AutomaticLevels(plus, 1), 1);
  EXPECT_EQ(AutomaticLevels(plus, 200), 1);
  EXPECT_EQ(AutomaticLevels(plus, 400), 2);
  EXPECT_EQ(AutomaticLevels(plus, 700), 2);
  EXPECT_EQ(AutomaticLevels(plus, 702), 3);
  EXPECT_EQ(AutomaticLevels(plus, 800), 3);
  EXPECT_EQ(AutomaticLevels(plus, 1600), 4);
  EXPECT_EQ(AutomaticLevels(plus, 3200), 5);
}

}  // namespace
}  // namespace hpm
