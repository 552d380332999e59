// What a stage does between its passes: which hypotheses of a coarser level
// stay, and which priors a backend gets.
#include "src/engine/run_passes.h"

#include "tests/engine/half_textured.h"
#include "tests/engine/still_backend.h"

#include <cmath>
#include <memory>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 48, kHeight = 24;
constexpr float kCoarseDepth = 4, kFineDepth = 5;
constexpr float kCoarseCost = 0.5f;

// What Run() saw of a pass.
struct Seen {
  PassKind kind;
  int prior_level;
  size_t num_priors;
  std::vector<Plane> planes;
  std::vector<uint8_t> visits;
};

// The first pass judges the planes it finds, all alike; any other gives each
// pixel a plane and the cost of its row.
class ScriptedBackend : public StillBackend {
 public:
  explicit ScriptedBackend(bool upsamples)
      : StillBackend(&log_), upsamples_(upsamples) {}

  bool UpsamplesPriors() const override { return upsamples_; }
  void Run(const Pass& pass,
           const SamplingPattern&,
           HypothesisMap* map,
           const RunControl&) override {
    seen.push_back({pass.kind,
                    map->prior_level,
                    map->priors.size(),
                    map->planes,
                    map->visits});
    const bool judges = pass.num_iterations == 0;
    for (size_t i = 0; i < map->planes.size(); ++i) {
      map->costs[i] = judges ? kCoarseCost : costs_of_rows[i / kWidth];
      if (!judges) map->planes[i] = {{0, 0, -1}, kFineDepth};
    }
    map->Touch();
  }
  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl&) override {
    std::vector<float> costs;
    for (const PixelPlane& pixel : planes)
      costs.push_back(std::fabs(pixel.plane.distance - matching_depth) < 0.5f
                          ? 0.1f
                          : 0.4f);
    return costs;
  }

  std::vector<Seen> seen;
  float matching_depth = kFineDepth;  // of planes that face the camera
  std::vector<float> costs_of_rows = std::vector<float>(kHeight, 0.01f);

 private:
  StillLog log_;
  bool upsamples_;
};

ViewSet LeftHalfTextured() { return HalfTextured(kWidth, kHeight, kWidth / 2); }

// The stage of the method at full size that follows a coarser level, if
// `from_coarser`, else the first one.
void RunStageOf(const std::string& method,
                bool from_coarser,
                ScriptedBackend* backend,
                HypothesisMap* map) {
  ScheduleOptions options;
  options.method = method;
  options.num_levels = 2;
  const Schedule schedule = MakeSchedule(options);
  const CancelToken cancel;
  PhaseTimes times;
  for (const StageSpec& stage : schedule.stages) {
    if (stage.from_coarser != from_coarser) continue;
    RunPasses(backend,
              LeftHalfTextured(),
              schedule,
              stage,
              DefaultParams(FindMethod(method)),
              {&cancel, nullptr},
              map,
              &times);
    return;
  }
  FAIL() << method << " has no such stage";
}

HypothesisMap CoarseMap() {
  HypothesisMap map(kWidth, kHeight);
  map.planes.assign(map.planes.size(), {{0, 0, -1}, kCoarseDepth});
  return map;
}

constexpr int kTextured = 5, kPlain = 40;  // columns

TEST(RunPasses, ATexturedPixelIsSearchedFromRandomPlanesAPlainOneIsNot) {
  ScriptedBackend backend(false);
  HypothesisMap map = CoarseMap();
  RunStageOf(kDefaultMethod, true, &backend, &map);
  ASSERT_EQ(backend.seen.size(), 2u);
  const std::vector<Plane>& given = backend.seen[1].planes;
  EXPECT_EQ(given[10 * kWidth + kTextured].distance, 0);
  EXPECT_EQ(given[10 * kWidth + kPlain].distance, kCoarseDepth);
}

TEST(RunPasses, UpdatesPassOverWhatTheCoarserLevelSettled) {
  ScriptedBackend backend(false);
  HypothesisMap map = CoarseMap();
  RunStageOf(kDefaultMethod, true, &backend, &map);
  ASSERT_EQ(backend.seen.size(), 2u);
  EXPECT_TRUE(backend.seen[0].visits.empty());
  ASSERT_EQ(backend.seen[1].visits.size(), map.planes.size());
  EXPECT_EQ(backend.seen[1].visits[10 * kWidth + kTextured], 255);
  EXPECT_EQ(backend.seen[1].visits[10 * kWidth + kPlain], 0);
  EXPECT_TRUE(map.visits.empty());
}

// Where the level searched itself it must match clearly worse to lose,
// elsewhere the better match wins.
TEST(RunPasses, WhatALevelKeepsOfTheCoarserOne) {
  struct Case {
    float own_cost;
    float textured, plain;  // whose plane stays
  };
  const std::vector<Case> cases = {
      {kCoarseCost - 0.15f, kFineDepth, kFineDepth},
      {kCoarseCost - 0.05f, kFineDepth, kFineDepth},
      {kCoarseCost + 0.05f, kFineDepth, kCoarseDepth},
      {kCoarseCost + 0.15f, kCoarseDepth, kCoarseDepth}};
  for (const Case& c : cases) {
    ScriptedBackend backend(false);
    backend.costs_of_rows.assign(kHeight, c.own_cost);
    HypothesisMap map = CoarseMap();
    RunStageOf(kDefaultMethod, true, &backend, &map);
    for (const auto& [col, depth] :
         {std::pair(kTextured, c.textured), std::pair(kPlain, c.plain)}) {
      const size_t at = 10 * kWidth + col;
      EXPECT_EQ(map.planes[at].distance, depth) << c.own_cost << " " << col;
      EXPECT_EQ(map.costs[at], depth == kFineDepth ? c.own_cost : kCoarseCost);
    }
  }
}

// The last stage of the default, whose source is sure of this depth.
void RunGeometricStage(ViewSet views,
                       float depth,
                       ScriptedBackend* backend,
                       HypothesisMap* map) {
  views.srcs[0].inverse_depth = std::make_shared<const InverseDepthMap>(
      InverseDepthMap::Of(std::vector<float>(kWidth * kHeight, 1 / depth)));
  const Schedule schedule = MakeSchedule({kDefaultMethod});
  const StageSpec& stage = schedule.stages.back();
  ASSERT_TRUE(stage.geometric);
  const CancelToken cancel;
  PhaseTimes times;
  RunPasses(backend,
            views,
            schedule,
            stage,
            DefaultParams(FindMethod(kDefaultMethod)),
            {&cancel, nullptr},
            map,
            &times);
  ASSERT_FALSE(backend->seen.empty());
}

TEST(RunPasses, AGeometricPassPassesOverWhatLiesOnItsPrior) {
  ViewSet views = LeftHalfTextured();
  views.srcs[0].camera.t = {-1, 0, 0};
  ScriptedBackend backend(false);
  backend.matching_depth = kCoarseDepth;
  HypothesisMap map = CoarseMap();
  RunGeometricStage(views, kCoarseDepth, &backend, &map);
  ASSERT_EQ(backend.seen[0].visits.size(), map.planes.size());
  EXPECT_EQ(backend.seen[0].visits[10 * kWidth + kTextured], 255);
  EXPECT_EQ(backend.seen[0].visits[10 * kWidth + kPlain], 0);
  EXPECT_TRUE(map.visits.empty());
}

TEST(RunPasses, AGeometricPassStartsFromWhatASourceFound) {
  ScriptedBackend backend(false);
  HypothesisMap map = CoarseMap();
  RunGeometricStage(LeftHalfTextured(), kFineDepth, &backend, &map);
  const std::vector<Plane>& given = backend.seen[0].planes;
  EXPECT_NEAR(given[10 * kWidth + kTextured].distance, kFineDepth, 1e-3);
  EXPECT_EQ(given[10 * kWidth + kPlain].distance, kCoarseDepth);
}

// ACMM's detail restoration: nothing is forgotten, the coarse level wins but
// where the fine one is clearly better.
TEST(RunPasses, APyramidKeepsTheCoarserLevelUnlessItsOwnIsClearlyBetter) {
  for (const float own_cost : {kCoarseCost - 0.15f, kCoarseCost - 0.05f}) {
    ScriptedBackend backend(false);
    backend.costs_of_rows.assign(kHeight, own_cost);
    HypothesisMap map = CoarseMap();
    RunStageOf("acmm", true, &backend, &map);
    const float depth =
        own_cost < kCoarseCost - 0.1f ? kFineDepth : kCoarseDepth;
    for (const int col : {kTextured, kPlain})
      EXPECT_EQ(map.planes[10 * kWidth + col].distance, depth) << own_cost;
  }
}

TEST(RunPasses, BackendsThatUpsampleGetPriorsOfTheirLevelOthersOfFullSize) {
  for (const bool upsamples : {false, true}) {
    ScriptedBackend backend(upsamples);
    HypothesisMap map(kWidth, kHeight);
    RunStageOf("hpm", false, &backend, &map);
    ASSERT_EQ(backend.seen.size(), 3u);
    const size_t full = kWidth * kHeight;
    EXPECT_EQ(backend.seen[0].num_priors, 0u);
    EXPECT_EQ(backend.seen[1].kind, PassKind::kPrior);
    EXPECT_EQ(backend.seen[1].prior_level, upsamples ? 1 : 0);
    EXPECT_EQ(backend.seen[1].num_priors, upsamples ? full / 4 : full);
    EXPECT_EQ(backend.seen[2].prior_level, 0);
    EXPECT_EQ(backend.seen[2].num_priors, full);
    EXPECT_TRUE(map.priors.empty());
    EXPECT_EQ(map.prior_level, 0);
  }
}

}  // namespace
}  // namespace hpm
