#include "src/cpu/cpu_backend.h"

#include "src/core/sampling_pattern.h"
#include "tests/cpu/scene_views.h"
#include "tests/engine/compare_maps.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <thread>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 48;
constexpr int kHeight = 37;

const Pass kBasic = {PassKind::kBasic, StartFrom::kRandom, 2, 0, 0};
const Pass kGeometric = {PassKind::kGeometric, StartFrom::kCurrent, 1, 1, 0};

class CpuBackendTest : public testing::Test {
 protected:
  static ViewSet MakeViews() {
    SceneOptions options;
    options.num_views = 4;
    options.width = kWidth;
    options.height = kHeight;
    const auto rendered = RenderViews(MakeScene("sphere", options), 1);
    ViewSet views = AsViewSet(rendered);
    AddTrueDepths(rendered, 0, &views);
    return views;
  }

  struct Result {
    HypothesisMap map;
    std::vector<uint32_t> consistent;
    uint64_t num_evaluations;
  };

  Result RunAll(int num_threads, uint64_t key = 42) {
    ViewSet views = views_;
    views.random_key = key;
    const auto backend = MakeCpuBackend("auto", num_threads);
    backend->SetViews(views, MethodParams());
    Result result = {HypothesisMap(kWidth, kHeight), {}, 0};
    backend->Run(kBasic, pattern_, &result.map, control_);
    backend->Run(kGeometric, pattern_, &result.map, control_);
    result.consistent = backend->ConsistentViews(
        result.map, {0.1f, 0.05f, 1.0f, 2}, true, control_);
    result.num_evaluations = backend->num_cost_evaluations();
    return result;
  }

  const ViewSet views_ = MakeViews();
  const SamplingPattern pattern_ = MakeSamplingPattern(true, true);
  CancelToken cancel_;
  RunControl control_ = {&cancel_, nullptr};
};

TEST_F(CpuBackendTest, OneAndTwoThreadsGiveTheSameBytes) {
  const Result one = RunAll(1);
  const Result two = RunAll(2);
  EXPECT_TRUE(SameMaps(one.map, two.map));
  EXPECT_EQ(one.consistent, two.consistent);
  EXPECT_EQ(one.num_evaluations, two.num_evaluations);
  EXPECT_GT(one.num_evaluations, 0u);
}

// An image of several tiles, high and low ones: a random start asks all views
// once for each pixel.
TEST_F(CpuBackendTest, TilesHoldEveryPixelOnce) {
  constexpr int kWide = 2 * 128 + 21, kHigh = 3 * 16 + 5;
  SceneOptions options;
  options.num_views = 3;
  options.width = kWide;
  options.height = kHigh;
  const ViewSet views =
      AsViewSet(RenderViews(MakeScene("tilted_plane", options), 1));
  Pass start = kBasic;
  start.num_iterations = 0;
  start.median = false;
  std::vector<HypothesisMap> maps;
  for (const int num_threads : {1, 8}) {
    const auto backend = MakeCpuBackend("auto", num_threads);
    backend->SetViews(views, MethodParams());
    maps.emplace_back(kWide, kHigh);
    backend->Run(start, pattern_, &maps.back(), control_);
    EXPECT_EQ(backend->num_cost_evaluations(), uint64_t{2} * kWide * kHigh);
    for (const Plane& plane : maps.back().planes) ASSERT_GT(plane.distance, 0);
  }
  EXPECT_TRUE(SameMaps(maps[0], maps[1]));
}

TEST_F(CpuBackendTest, ForgottenViewsAreHeldNoLonger) {
  const auto backend = MakeCpuBackend("auto", 1);
  const auto& depth = views_.srcs[0].inverse_depth;
  const auto num_holders = depth.use_count();
  backend->SetViews(views_, MethodParams());
  EXPECT_GT(depth.use_count(), num_holders);
  backend->ForgetViews();
  EXPECT_EQ(depth.use_count(), num_holders);
}

// The costs are taken as they are: only the iterations count.
TEST_F(CpuBackendTest, AStoredStartComputesNoCosts) {
  const auto backend = MakeCpuBackend("auto", 2);
  backend->SetViews(views_, MethodParams());
  HypothesisMap map(kWidth, kHeight);
  backend->Run(kBasic, pattern_, &map, control_);
  const HypothesisMap before = map;
  const uint64_t num_before = backend->num_cost_evaluations();
  Pass stored = kBasic;
  stored.start = StartFrom::kStored;
  stored.num_iterations = 0;
  stored.median = false;
  backend->Run(stored, pattern_, &map, control_);
  EXPECT_EQ(backend->num_cost_evaluations(), num_before);
  EXPECT_TRUE(SameBytes(before.costs, map.costs));
  EXPECT_TRUE(SameBytes(before.planes, map.planes));
}

// However many planes a pixel has.
TEST_F(CpuBackendTest, ScoresPlanesAsAPassOverAMapWould) {
  const auto backend = MakeCpuBackend("auto", 2);
  backend->SetViews(views_, MethodParams());
  Pass judge = {PassKind::kBasic, StartFrom::kCurrent, 0, 0, 0, false};
  judge.ask_all_views = true;
  std::vector<PixelPlane> planes;
  std::vector<float> expected;
  for (const float depth : {4.0f, 5.0f, 7.0f}) {
    HypothesisMap map(kWidth, kHeight);
    for (int i = 0; i < kWidth * kHeight; ++i) {
      const int col = i % kWidth, row = i / kWidth;
      map.planes[i] = PlaneFromDepth(views_.ref.camera,
                                     static_cast<float>(col),
                                     static_cast<float>(row),
                                     depth,
                                     {0, 0, -1});
      planes.push_back({col, row, map.planes[i]});
    }
    backend->Run(judge, pattern_, &map, control_);
    expected.insert(expected.end(), map.costs.begin(), map.costs.end());
  }
  const uint64_t num_before = backend->num_cost_evaluations();
  EXPECT_TRUE(SameBytes(backend->Score(planes, control_), expected));
  EXPECT_EQ(backend->num_cost_evaluations(), 2 * num_before);
  EXPECT_LT(*std::min_element(expected.begin(), expected.end()), 0.5f);
  EXPECT_TRUE(backend->Score({}, control_).empty());
}

// The other colour follows those that were visited, or stays as it was.
TEST_F(CpuBackendTest, AHalfPassVisitsOneColour) {
  const auto backend = MakeCpuBackend("auto", 2);
  backend->SetViews(views_, MethodParams());
  HypothesisMap map(kWidth, kHeight);
  backend->Run(kBasic, pattern_, &map, control_);
  const HypothesisMap before = map;
  HypothesisMap full = map;
  Pass pass = kGeometric;
  pass.median = false;
  uint64_t num_costs = backend->num_cost_evaluations();
  backend->Run(pass, pattern_, &full, control_);
  const uint64_t num_of_full = backend->num_cost_evaluations() - num_costs;
  num_costs = backend->num_cost_evaluations();
  pass.half_visits = true;
  backend->Run(pass, pattern_, &map, control_);
  EXPECT_LT(backend->num_cost_evaluations() - num_costs, 0.8 * num_of_full);
  const auto same_plane = [&](const Plane& a, const Plane& b) {
    return std::memcmp(&a, &b, sizeof(Plane)) == 0;
  };
  int num_following = 0, num_moved = 0;
  for (int row = 1; row + 1 < kHeight; ++row) {
    for (int col = 1; col + 1 < kWidth; ++col) {
      const int at = row * kWidth + col;
      if ((col + row) % 2 == 1) {
        num_moved += !same_plane(map.planes[at], before.planes[at]);
        continue;
      }
      bool follows = false;
      for (const int beside : {at - kWidth, at - 1, at + 1, at + kWidth})
        follows |= same_plane(map.planes[at], map.planes[beside]);
      num_following += follows;
      EXPECT_TRUE(follows || same_plane(map.planes[at], before.planes[at]));
    }
  }
  EXPECT_GT(num_following, 600);
  EXPECT_GT(num_moved, 300);
}

// To follow takes no time that a person waits for.
TEST_F(CpuBackendTest, TheProgressOfAHalfPassCountsItsVisits) {
  const auto backend = MakeCpuBackend("auto", 1);
  backend->SetViews(views_, MethodParams());
  HypothesisMap map(kWidth, kHeight);
  Pass pass = {PassKind::kBasic, StartFrom::kRandom, 3, 0};
  pass.half_visits = true;
  uint64_t num_costs = 0;
  int num_steps = 0;
  double share = 0;
  backend->Run(
      pass, pattern_, &map, {&cancel_, [&](double done) {
                               EXPECT_GT(backend->num_cost_evaluations(),
                                         num_costs);
                               num_costs = backend->num_cost_evaluations();
                               EXPECT_GT(done, share);
                               share = done;
                               ++num_steps;
                             }});
  EXPECT_EQ(num_steps, 2 + 3);
  EXPECT_EQ(share, 1);
}

TEST_F(CpuBackendTest, AnotherSeedGivesAnotherMap) {
  EXPECT_FALSE(SameBytes(RunAll(2, 1).map.planes, RunAll(2, 2).map.planes));
}

TEST_F(CpuBackendTest, SettingTheViewsAgainLeavesNothingBehind) {
  const auto backend = MakeCpuBackend("auto", 2);
  HypothesisMap maps[2];
  for (HypothesisMap& map : maps) {
    map = HypothesisMap(kWidth, kHeight);
    backend->SetViews(views_, MethodParams());
    EXPECT_EQ(backend->num_cost_evaluations(), 0u);
    backend->Run(kBasic, pattern_, &map, control_);
  }
  EXPECT_TRUE(SameBytes(maps[0].planes, maps[1].planes));
}

TEST_F(CpuBackendTest, ProgressRisesToOne) {
  std::vector<double> fractions;
  control_.progress = [&](double f) { fractions.push_back(f); };
  RunAll(2);
  ASSERT_GT(fractions.size(), 4u);
  EXPECT_EQ(fractions.back(), 1);
  const size_t first_pass = 2 + 2 * 2;
  for (size_t i = 1; i < first_pass; ++i) {
    EXPECT_GT(fractions[i], fractions[i - 1]);
  }
}

TEST_F(CpuBackendTest, NameTellsTargetAndThreads) {
  EXPECT_EQ(MakeCpuBackend("scalar", 2)->Name(), "cpu scalar, 2 threads");
}

TEST_F(CpuBackendTest, MemoryNeededCoversTheImagesAndTheState) {
  const auto backend = MakeCpuBackend("scalar", 1);
  const uint64_t pixels = 1000 * 1000;
  // At least a texel per source pixel, and plane, cost and mask per pixel.
  EXPECT_GE(backend->MemoryNeeded(1000, 1000, 10), pixels * (20 + 24));
  EXPECT_GT(backend->MemoryNeeded(40000, 30000, 1), 1ull << 32);
}

TEST_F(CpuBackendTest, CancelledTokenInterruptsBeforeAnyWork) {
  cancel_.Cancel();
  try {
    RunAll(2);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInterrupted);
  }
}

TEST_F(CpuBackendTest, CancellingStopsALongRunPromptly) {
  const auto backend = MakeCpuBackend("auto", 2);
  backend->SetViews(views_, MethodParams());
  HypothesisMap map(kWidth, kHeight);
  Pass endless = kBasic;
  endless.num_iterations = 1000000;
  using Clock = std::chrono::steady_clock;
  std::atomic<Clock::rep> cancelled_at{0};
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    cancelled_at = Clock::now().time_since_epoch().count();
    cancel_.Cancel();
  });
  ErrorCode code = ErrorCode::kFailure;
  try {
    backend->Run(endless, pattern_, &map, control_);
  } catch (const Error& error) {
    code = error.code();
  }
  const auto stopped_at = Clock::now().time_since_epoch().count();
  canceller.join();
  EXPECT_EQ(code, ErrorCode::kInterrupted);
  const Clock::duration took(stopped_at - cancelled_at);
  // A row takes milliseconds; the rest is for a busy machine and sanitizers.
  EXPECT_LT(std::chrono::duration<double>(took).count(), 2);
}

}  // namespace
}  // namespace hpm
