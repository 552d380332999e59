// cuda/cuda_backend.cc as it is, on a card that the host plays.
#include "tests/cuda/made_up_card.h"

#include "cuda/cuda_backend.h"
#include "src/core/sampling_pattern.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/gpu_error.h"
#include "src/gpu/self_test.h"
#include "tests/cpu/made_up_visits.h"
#include "tests/engine/compare_maps.h"
#include "tests/gpu/test_problem.h"
#include "tests/gpu/whole_runs.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 29, kHeight = 19;

struct Result {
  HypothesisMap map;
  std::vector<uint32_t> consistent;
  std::vector<float> scores;
  uint64_t num_evaluations = 0;
};

void ExpectSame(const Result& a, const Result& b) {
  EXPECT_TRUE(SameMaps(a.map, b.map));
  EXPECT_EQ(a.consistent, b.consistent);
  EXPECT_EQ(a.scores, b.scores);
  EXPECT_EQ(a.num_evaluations, b.num_evaluations);
}

class MadeUpCardTest : public testing::Test {
 protected:
  void TearDown() override {
    StartCounting();
    LetKernelsIdle(false);
    EXPECT_EQ(LiveAllocations(), 0);
  }

  static std::unique_ptr<CudaBackend> Make(
      ImageFormat format = ImageFormat::kByte) {
    CudaOptions options;
    options.format = format;
    return MakeCudaBackend(options);
  }

  // All kinds of start, with priors of both kinds, so that a map comes from the
  // host, stays on the card or is changed on the way.
  Result RunAll(Backend* backend) {
    backend->SetViews(views_, MethodParams());
    HypothesisMap map(kWidth, kHeight);
    const auto run = [&](PassKind kind, StartFrom start) {
      const Pass pass = {kind, start, 1, pass_id_++};
      backend->Run(pass, pattern_, &map, {&cancel_, nullptr});
    };
    pass_id_ = 0;
    run(PassKind::kBasic, StartFrom::kRandom);
    map.priors = map.planes;
    for (size_t i = 0; i < map.priors.size(); i += 7)
      map.priors[i].distance = 0;
    run(PassKind::kPrior, StartFrom::kPrior);
    map.priors = {};
    for (size_t i = 0; i < map.planes.size(); ++i) {
      if (i % 5 == 0) map.planes[i].distance = 0;
      map.costs[i] = 0.0015f * static_cast<float>(i * 7919 % 1000);
    }
    map.Touch();
    map.visits = MadeUpVisits(kWidth, kHeight);
    run(PassKind::kBasic, StartFrom::kMissing);
    backend->Run(HalfSearch(), pattern_, &map, {&cancel_, nullptr});
    map.visits = {};
    run(PassKind::kGeometric, StartFrom::kCurrent);
    for (size_t i = 0; i < map.planes.size(); i += 3) {
      map.planes[i].distance *= 1.01f;
      map.costs[i] = 0.5f;
    }
    map.Touch();
    run(PassKind::kGeometric, StartFrom::kCurrent);
    run(PassKind::kGeometric, StartFrom::kStored);
    Result result;
    std::vector<PixelPlane> planes;
    for (int i = 0; i < kWidth * kHeight; i += 2)
      planes.push_back({i % kWidth, i / kWidth, map.planes[i]});
    result.scores = backend->Score(planes, {&cancel_, nullptr});
    result.consistent = backend->ConsistentViews(
        map, {0.1f, 0.05f, 1.0f, 2}, true, {&cancel_, nullptr});
    result.map = map;
    result.num_evaluations = backend->num_cost_evaluations();
    return result;
  }

  const ViewSet views_ =
      MakeTestViews(RenderTestViews("depth_step", kWidth, kHeight));
  const SamplingPattern pattern_ = MakeSamplingPattern(true, true);
  const CancelToken cancel_;
  int pass_id_ = 0;
};

TEST_F(MadeUpCardTest, GivesTheBytesOfTheScalarCpuBackend) {
  const auto cpu = MakeCpuBackend("scalar", 1);
  const Result expected = RunAll(cpu.get());
  for (const ImageFormat format : {ImageFormat::kByte, ImageFormat::kQuad}) {
    const auto card = Make(format);
    ExpectSame(RunAll(card.get()), expected);
    ExpectSame(RunAll(card.get()), expected);  // with what is left from before
  }
}

TEST_F(MadeUpCardTest, WholeRunsGiveTheBytesOfTheScalarCpuBackend) {
  ExpectWholeRunsOfTheScalarCpuBackend([] { return Make(); });
}

// The engine merges levels on the host, whoever matches.
TEST_F(MadeUpCardTest, MemoryNeededCoversTwoMapsAndTheVisitsOnTheHost) {
  EXPECT_GE(Make()->MemoryNeeded(1000, 1000, 1), 1000u * 1000u * 49u);
}

// What the card made itself need not come back to it for the filter; what the
// host changed since must.
TEST_F(MadeUpCardTest, OnlyMapsThatTheHostChangedAreSentAgain) {
  const auto card = Make();
  card->SetViews(views_, MethodParams());
  HypothesisMap map(kWidth, kHeight);
  const RunControl control = {&cancel_, nullptr};
  const FilterParams filter = {0.1f, 0.05f, 1.0f, 2};
  const size_t plane_bytes = map.planes.size() * sizeof(Plane);
  card->Run(kBasic, pattern_, &map, control);
  StartCounting();
  const auto consistent = card->ConsistentViews(map, filter, true, control);
  EXPECT_LT(BytesSent(), plane_bytes);
  EXPECT_EQ(card->ConsistentViews(map, filter, true, control), consistent);
  card->Run(kGeometric, pattern_, &map, control);
  map.Touch();
  StartCounting();
  card->ConsistentViews(map, filter, true, control);
  EXPECT_GE(BytesSent(), plane_bytes);
}

// Whichever allocation it is, the error says so, nothing is lost to others, and
// with memory again the same object works.
TEST_F(MadeUpCardTest, LackOfMemoryIsAnErrorWhereverItStrikes) {
  StartCounting();
  const Result expected = RunAll(Make().get());
  const int num_calls = CallsOf(CardCall::kAllocate);
  ASSERT_GT(num_calls, 10);
  for (int i = 0; i < num_calls; ++i) {
    LetCallFail(CardCall::kAllocate, i, cudaErrorMemoryAllocation, false);
    std::unique_ptr<CudaBackend> card;
    try {
      card = Make();
      RunAll(card.get());
      ADD_FAILURE() << "allocation " << i;
    } catch (const GpuError& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfResources);
    }
    StartCounting();
    if (card != nullptr && i % 5 == 0) ExpectSame(RunAll(card.get()), expected);
  }
}

TEST_F(MadeUpCardTest, WithoutLockedMemoryTheDriverCopies) {
  const Result expected = RunAll(Make().get());
  for (int i = 0; i < 2; ++i) {
    LetCallFail(CardCall::kLock, i, cudaErrorMemoryAllocation, false);
    ExpectSame(RunAll(Make().get()), expected);
  }
}

TEST_F(MadeUpCardTest, ALaunchThatFailsIsAnError) {
  StartCounting();
  RunAll(Make().get());
  const int num_calls = CallsOf(CardCall::kLaunch);
  ASSERT_GT(num_calls, 20);
  for (int i = 0; i < num_calls; i += 3) {
    LetCallFail(CardCall::kLaunch, i, cudaErrorInvalidConfiguration, false);
    try {
      RunAll(Make().get());
      ADD_FAILURE() << "launch " << i;
    } catch (const GpuError& error) {
      EXPECT_EQ(error.code(), ErrorCode::kDevice);
    }
  }
}

// Whatever fails while a backend is made, nothing of it stays (TearDown).
TEST_F(MadeUpCardTest, ABackendThatCannotBeMadeLeavesNothing) {
  StartCounting();
  Make();
  const int num_calls = CallsOf(CardCall::kAny);
  ASSERT_GT(num_calls, 8);
  int num_failed = 0;
  for (int i = 0; i < num_calls; ++i) {
    LetCallFail(CardCall::kAny, i, cudaErrorDevicesUnavailable, false);
    try {
      Make();
    } catch (const GpuError&) {
      ++num_failed;
    }
    EXPECT_EQ(LiveAllocations(), 0) << i;
  }
  EXPECT_GT(num_failed, 6);
}

// From one call on nothing answers any more; the object still goes quietly.
TEST_F(MadeUpCardTest, ACardThatIsLostIsAnErrorWheneverItGoes) {
  StartCounting();
  const auto whole = Make();
  RunAll(whole.get());
  const int num_calls = CallsOf(CardCall::kAny);
  for (int i = 0; i < num_calls; i += 11) {
    LetCallFail(CardCall::kAny, i, cudaErrorDevicesUnavailable, true);
    try {
      RunAll(Make().get());
      ADD_FAILURE() << "call " << i;
    } catch (const GpuError& error) {
      EXPECT_EQ(error.code(), ErrorCode::kDevice) << i;
    }
  }
}

TEST_F(MadeUpCardTest, TheSelfTestRefusesACardThatDoesNothing) {
  EXPECT_EQ(SelfTestFailure(Make().get()), "");
  LetKernelsIdle(true);
  EXPECT_NE(SelfTestFailure(Make().get()), "");
}

}  // namespace
}  // namespace hpm
