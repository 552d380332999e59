#include "src/cpu/pixel_group.h"

#include "src/core/sampling_pattern.h"
#include "src/engine/sweeps.h"
#include "src/engine/visit_params.h"
#include "src/image/hypothesis_map.h"
#include "tests/cpu/made_up_visits.h"
#include "tests/cpu/scene_views.h"
#include "tests/engine/compare_maps.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 77;  // no whole number of groups
constexpr int kHeight = 34;

ViewSet MakeViews() {
  SceneOptions options;
  options.num_views = 6;
  options.width = kWidth;
  options.height = kHeight;
  const auto rendered = RenderViews(MakeScene("sphere", options), 1);
  ViewSet views = AsViewSet(rendered);
  views.ref = WithGap(views.ref, 9);
  AddTrueDepths(rendered, 1, &views);  // one has none
  return views;
}

// Visits one pixel after the other, each with its own costs.
uint64_t VisitOneByOne(const CpuViews& views,
                       const CpuTarget& target,
                       const SweepScope& scope) {
  uint64_t num_evaluations = 0;
  for (int row = 0; row < kHeight; ++row) {
    for (int col = (row + scope.sweep.color) % 2; col < kWidth; col += 2) {
      const CpuPixelCost cost(
          views, target, scope.params.geometric_term.max_error, col, row);
      if (scope.sweep.kind == SweepKind::kInitialize) {
        VisitPixel<SweepKind::kInitialize>(scope, cost, col, row);
      } else {
        VisitPixel<SweepKind::kUpdate>(scope, cost, col, row);
      }
      num_evaluations += cost.num_evaluations();
    }
  }
  return num_evaluations;
}

uint64_t VisitInGroups(const CpuViews& views,
                       const CpuTarget& target,
                       const SweepScope& scope) {
  PixelGroup group(views, target, scope);
  for (int row = 0; row < kHeight; ++row) {
    for (int col = (row + scope.sweep.color) % 2; col < kWidth;)
      col = group.Visit(col, row);
  }
  return group.num_evaluations();
}

class PixelGroupTest : public testing::TestWithParam<CpuTarget> {};
INSTANTIATE_TEST_SUITE_P(CpuTargets,
                         PixelGroupTest,
                         testing::ValuesIn(CpuTargets()),
                         [](const auto& test) { return test.param.name; });

// All sweeps of a random start, of a start with holes, and of a geometric pass
// with priors on some pixels.
TEST_P(PixelGroupTest, VisitsArePixelByPixelTheSame) {
  const ViewSet set = MakeViews();
  const SamplingPattern pattern = MakeSamplingPattern(true, true);
  for (const bool as_published : {true, false}) {
    MethodParams method;
    if (!as_published) {
      method.same_plane_bound = 0.2f;
      method.worst_cost = 1;
      method.max_views = 3;
    }
    const CpuViews views(set, method);
    HypothesisMap expected(kWidth, kHeight), actual = expected;
    std::vector<Plane> priors;
    std::vector<uint8_t> visits;
    int pass_id = 0;
    for (const StartFrom start :
         {StartFrom::kRandom, StartFrom::kMissing, StartFrom::kPrior}) {
      Pass pass = {
          start == StartFrom::kPrior ? PassKind::kGeometric : PassKind::kBasic,
          start,
          2,
          pass_id++};
      pass.ask_all_views = as_published;
      pass.search_near = !as_published && start == StartFrom::kPrior;
      if (start == StartFrom::kMissing) {
        for (size_t i = 0; i < expected.planes.size(); i += 3)
          expected.planes[i] = actual.planes[i] = {};
        visits = MadeUpVisits(kWidth, kHeight);
      }
      if (start == StartFrom::kPrior) {
        priors = expected.planes;
        for (size_t i = 0; i < priors.size(); i += 2) priors[i].distance = 0;
      }
      const VisitParams params =
          ForPass(MakeVisitParams(set, method), method, pass);
      for (const Sweep& sweep : SweepsOf(pass, 7)) {
        if (sweep.kind != SweepKind::kInitialize &&
            sweep.kind != SweepKind::kUpdate)
          continue;
        PixelState states[2] = {expected.View(), actual.View()};
        for (PixelState& state : states)
          state.priors = priors.empty() ? nullptr : priors.data();
        for (PixelState& state : states)
          state.visits = visits.empty() ? nullptr : visits.data();
        const std::vector<Plane> before = expected.planes;
        const uint64_t num_expected = VisitOneByOne(
            views,
            GetParam(),
            {params, pattern, sweep, states[0], nullptr, nullptr});
        const uint64_t num_actual = VisitInGroups(
            views,
            GetParam(),
            {params, pattern, sweep, states[1], nullptr, nullptr});
        EXPECT_EQ(num_expected, num_actual);
        EXPECT_GT(num_actual, 0u);
        ASSERT_TRUE(SameMaps(expected, actual))
            << "start " << static_cast<int>(start) << ", colour "
            << sweep.color;
        if (sweep.kind != SweepKind::kUpdate) continue;
        for (size_t i = 0; i < visits.size(); ++i) {
          if (visits[i] > sweep.iteration) continue;
          ASSERT_EQ(expected.planes[i].distance, before[i].distance);
        }
      }
    }
  }
}

}  // namespace
}  // namespace hpm
