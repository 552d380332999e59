// Tests that need a card; without one each is skipped and says so.
#include "cuda/cuda_backend.h"
#include "cuda/cuda_devices.h"
#include "src/core/sampling_pattern.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/gpu_error.h"
#include "src/gpu/self_test.h"
#include "tests/cpu/made_up_visits.h"
#include "tests/engine/compare_maps.h"
#include "tests/gpu/emulated_backend.h"
#include "tests/gpu/test_problem.h"

#include <cmath>
#include <thread>

#include <gtest/gtest.h>

namespace hpm {
namespace {

class GpuTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string why_none;
    if (FindCudaDevices(&why_none).empty()) {
      GTEST_SKIP() << "no GPU: " << why_none;
    }
  }

  static std::unique_ptr<CudaBackend> Make(ImageFormat format,
                                           double launch_seconds = 0.03) {
    CudaOptions options;
    options.format = format;
    options.launch_seconds = launch_seconds;
    return MakeCudaBackend(options);
  }

  static ViewSet MakeViews(const std::string& scene, int width, int height) {
    rendered_ = RenderTestViews(scene, width, height);
    return MakeTestViews(rendered_);
  }

  struct Result {
    HypothesisMap basic, prior, geometric, half;
    std::vector<uint32_t> consistent;
    uint64_t num_evaluations = 0;
  };

  Result RunAll(Backend* backend, const ViewSet& views) {
    Result result;
    backend->SetViews(views, MethodParams());
    HypothesisMap map(views.ref.camera.width, views.ref.camera.height);
    backend->Run(kBasic, pattern_, &map, control_);
    result.basic = map;
    map.priors = map.planes;
    for (size_t i = 0; i < map.priors.size(); i += 7) {
      map.priors[i].distance = 0;
    }
    backend->Run(kPrior, pattern_, &map, control_);
    map.priors = {};
    result.prior = map;
    map.visits = MadeUpVisits(map.width, map.height);
    backend->Run(kGeometric, pattern_, &map, control_);
    backend->Run(HalfSearch(), pattern_, &map, control_);
    map.visits = {};
    result.geometric = map;
    backend->Run(HalfPass(), pattern_, &map, control_);
    result.half = map;
    result.consistent =
        backend->ConsistentViews(map, {0.1f, 0.05f, 1.0f, 2}, true, control_);
    result.num_evaluations = backend->num_cost_evaluations();
    return result;
  }

  static void ExpectSameBytes(const Result& a, const Result& b) {
    EXPECT_TRUE(SameBytes(a.basic.planes, b.basic.planes));
    EXPECT_TRUE(SameBytes(a.prior.planes, b.prior.planes));
    EXPECT_TRUE(SameMaps(a.geometric, b.geometric));
    EXPECT_TRUE(SameBytes(a.half.planes, b.half.planes));
    EXPECT_EQ(a.consistent, b.consistent);
    EXPECT_EQ(a.num_evaluations, b.num_evaluations);
  }

  inline static std::vector<RenderedView> rendered_;
  const SamplingPattern pattern_ = MakeSamplingPattern(true, true);
  CancelToken cancel_;
  RunControl control_ = {&cancel_, nullptr};
};

class EveryFormat : public GpuTest,
                    public testing::WithParamInterface<ImageFormat> {
 protected:
  static const char* Name() {
    return GetParam() == ImageFormat::kQuad ? "quad" : "byte";
  }
};
INSTANTIATE_TEST_SUITE_P(Gpu,
                         EveryFormat,
                         testing::Values(ImageFormat::kByte,
                                         ImageFormat::kQuad),
                         [](const auto& test) {
                           return test.param == ImageFormat::kQuad ? "Quad"
                                                                   : "Byte";
                         });

TEST_P(EveryFormat, PassesTheSelfTest) {
  EXPECT_EQ(SelfTestFailure(Make(GetParam()).get()), "");
}

// View by view, so that a score is one matching cost.
TEST_P(EveryFormat, ScoresAreThoseOfTheHost) {
  const ViewSet views = MakeViews("sphere", 96, 72);
  const auto gpu = Make(GetParam());
  EmulatedBackend host({EmulatedCost::kCore, 3, 16});
  std::mt19937 random(7);
  std::vector<PixelPlane> planes;
  for (int i = 0; i < 96 * 72; ++i) {
    planes.push_back({i % 96,
                      i / 96,
                      SomeHypothesis(rendered_[0], i % 96, i / 96, &random)});
  }
  double sum = 0;
  float largest = 0;
  int num_off = 0;
  for (const View& src : views.srcs) {
    ViewSet one = views;
    one.srcs = {src};
    gpu->SetViews(one, MethodParams());
    host.SetViews(one, MethodParams());
    const std::vector<float> expected = host.Score(planes, control_);
    const std::vector<float> actual = gpu->Score(planes, control_);
    ASSERT_EQ(actual.size(), expected.size());
    for (size_t i = 0; i < expected.size(); ++i) {
      ASSERT_TRUE(actual[i] >= 0 && actual[i] <= kMaxCost) << i;
      const float difference = std::abs(actual[i] - expected[i]);
      if ((actual[i] == kMaxCost) != (expected[i] == kMaxCost) &&
          difference > 0.1f) {
        ++num_off;  // at the border of the source
        continue;
      }
      sum += difference;
      largest = std::fmax(largest, difference);
    }
  }
  const size_t num_costs = planes.size() * views.srcs.size();
  const double mean = sum / static_cast<double>(num_costs);
  std::printf("%s: cost difference mean %.6f, largest %.4f, visibility %d\n",
              Name(),
              mean,
              static_cast<double>(largest),
              num_off);
  const bool exact = GetParam() == ImageFormat::kQuad;
  EXPECT_LT(largest, exact ? 2e-3f : 0.2f);
  EXPECT_LT(mean, exact ? 1e-4 : 2e-3);
  EXPECT_LE(num_off, static_cast<int>(num_costs / 2000));
}

TEST_P(EveryFormat, MapsAreThoseOfTheCpuButForTies) {
  const auto gpu = Make(GetParam());
  const auto cpu = MakeCpuBackend("scalar", 0);
  for (const char* scene : {"sphere", "depth_step", "tilted_plane"}) {
    const ViewSet views = MakeViews(scene, 160, 120);
    const Result a = RunAll(gpu.get(), views);
    const Result b = RunAll(cpu.get(), views);
    const double basic = DifferingShare(a.basic, b.basic, views.ref.camera);
    const double geometric =
        DifferingShare(a.geometric, b.geometric, views.ref.camera);
    const double half = DifferingShare(a.half, b.half, views.ref.camera);
    std::printf("%s %s: basic %.4f, geometric %.4f, half %.4f\n",
                Name(),
                scene,
                basic,
                geometric,
                half);
    EXPECT_LT(basic, 0.1) << scene;
    EXPECT_LT(geometric, 0.08) << scene;
    EXPECT_LT(half, 0.08) << scene;
  }
}

TEST_P(EveryFormat, TwoRunsGiveTheSameBytesAlsoInOtherBands) {
  const ViewSet views = MakeViews("depth_step", 200, 150);
  const Result once = RunAll(Make(GetParam()).get(), views);
  ExpectSameBytes(RunAll(Make(GetParam()).get(), views), once);
  ExpectSameBytes(RunAll(Make(GetParam(), 1e-5).get(), views), once);
}

TEST_F(GpuTest, SeveralStreamsDoNotDisturbEachOther) {
  const ViewSet views = MakeViews("sphere", 160, 120);
  const Result expected = RunAll(Make(ImageFormat::kByte).get(), views);
  std::vector<Result> results(4);
  std::vector<std::thread> threads;
  for (Result& result : results) {
    threads.emplace_back(
        [&] { result = RunAll(Make(ImageFormat::kByte).get(), views); });
  }
  for (std::thread& thread : threads) thread.join();
  for (const Result& result : results) ExpectSameBytes(result, expected);
}

TEST_F(GpuTest, OneBackendTakesProblemsOfAllSizes) {
  const auto reused = Make(ImageFormat::kByte);
  for (const auto& [width, height] :
       {std::pair(160, 120), std::pair(61, 43), std::pair(200, 150)}) {
    const ViewSet views = MakeViews("tilted_plane", width, height);
    ExpectSameBytes(RunAll(reused.get(), views),
                    RunAll(Make(ImageFormat::kByte).get(), views));
  }
}

TEST_F(GpuTest, StopsWhenCancelled) {
  const auto gpu = Make(ImageFormat::kByte);
  const ViewSet views = MakeViews("sphere", 160, 120);
  gpu->SetViews(views, MethodParams());
  HypothesisMap map(160, 120);
  Pass endless = kBasic;
  endless.num_iterations = 1000000;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(300));
    cancel_.Cancel();
  });
  ErrorCode code = ErrorCode::kFailure;
  try {
    gpu->Run(endless, pattern_, &map, control_);
  } catch (const Error& error) {
    code = error.code();
  }
  canceller.join();
  EXPECT_EQ(code, ErrorCode::kInterrupted);
  // It goes on afterwards.
  CancelToken fresh;
  gpu->Run(kBasic, pattern_, &map, {&fresh, nullptr});
}

TEST_F(GpuTest, TooLargeAProblemIsAnErrorThatLeavesTheCardUsable) {
  const ViewSet views = MakeViews("sphere", 160, 120);
  const auto gpu = Make(ImageFormat::kByte);
  gpu->SetViews(views, MethodParams());
  // Wider than a texture can be.
  ViewSet wide = views;
  const int width = 200000;
  wide.srcs[0].camera.width = width;
  wide.srcs[0].camera.height = 1;
  wide.srcs[0].image = std::make_shared<const GrayImage>(
      GrayImage{width, 1, std::vector<uint8_t>(width)});
  wide.srcs[0].inverse_depth = nullptr;
  EXPECT_THROW(gpu->SetViews(wide, MethodParams()), GpuError);
  EXPECT_EQ(SelfTestFailure(gpu.get()), "");
}

// 108 million pixels: planes lie beyond 2^31 bytes. Only where the card and the
// host have room.
TEST_F(GpuTest, LargeImagesAreAddressedToTheirEnd) {
  std::string why_none;
  if (FindCudaDevices(&why_none)[0].free_bytes < (8ull << 30)) {
    GTEST_SKIP() << "less than 8 GiB free";
  }
  const int width = 12000, height = 9000;
  ViewSet views;
  GrayImage image{width, height, {}};
  std::mt19937 random(1);
  image.data.resize(static_cast<size_t>(width) * height);
  for (size_t i = 0; i < image.data.size(); ++i) {
    image.data[i] = static_cast<uint8_t>(random() >> 24);
  }
  Camera camera = {width,
                   height,
                   9000,
                   9000,
                   0.5f * width,
                   0.5f * height,
                   {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
                   {0, 0, 0}};
  views.ref = {
      camera, std::make_shared<const GrayImage>(std::move(image)), nullptr};
  // The source is the same picture from the same place: every plane fits.
  views.srcs.push_back(views.ref);
  views.depth_min = 1;
  views.depth_max = 2;
  views.random_key = 1;
  for (const ImageFormat format : {ImageFormat::kByte, ImageFormat::kQuad}) {
    const auto gpu = Make(format);
    gpu->SetViews(views, MethodParams());
    HypothesisMap map(width, height);
    gpu->Run({PassKind::kBasic, StartFrom::kRandom, 1, 0, 0, true},
             pattern_,
             &map,
             control_);
    size_t num_bad = 0;
    for (const float cost : map.costs) num_bad += !(cost < 0.01f);
    EXPECT_LT(num_bad, map.costs.size() / 1000);
    EXPECT_LT(map.costs.back(), 0.01f);
    EXPECT_GT(map.planes.back().distance, 0);
    EXPECT_LT(gpu->longest_launch(), 0.1);
  }
}

}  // namespace
}  // namespace hpm
