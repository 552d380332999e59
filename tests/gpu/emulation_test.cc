// The CUDA backend's parts, driven on the host, against the CPU backend. What
// a card adds to this is its own rounding and its hardware.
#include "src/core/sampling_pattern.h"
#include "src/cpu/cpu_backend.h"
#include "tests/cpu/made_up_visits.h"
#include "tests/engine/compare_maps.h"
#include "tests/gpu/emulated_backend.h"
#include "tests/gpu/test_problem.h"
#include "tests/gpu/whole_runs.h"

#include <cstdio>
#include <memory>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 61;
constexpr int kHeight = 43;

const FilterParams kFilter = {0.1f, 0.05f, 1.0f, 2};

struct Result {
  HypothesisMap basic, prior, geometric, half, last;
  std::vector<uint32_t> photometric_filter, geometric_filter;
  uint64_t num_evaluations = 0;
};

class EmulationTest : public testing::Test {
 protected:
  static ViewSet MakeViews(const std::string& scene, int width, int height) {
    return MakeTestViews(RenderTestViews(scene, width, height));
  }

  // A prior on a part of the image, near the truth.
  static std::vector<Plane> MakePriors(const HypothesisMap& map) {
    std::vector<Plane> priors = map.planes;
    for (size_t i = 0; i < priors.size(); ++i) {
      if (i % 7 == 0) priors[i].distance = 0;
    }
    return priors;
  }

  Result RunAll(Backend* backend,
                const ViewSet& views,
                const SamplingPattern& pattern) {
    const int width = views.ref.camera.width;
    const int height = views.ref.camera.height;
    Result result;
    backend->SetViews(views, MethodParams());
    HypothesisMap map(width, height);
    backend->Run(kBasic, pattern, &map, control_);
    result.basic = map;
    map.priors = MakePriors(map);
    backend->Run(kPrior, pattern, &map, control_);
    map.priors = {};
    result.prior = map;
    backend->Run(kGeometric, pattern, &map, control_);
    result.geometric = map;
    backend->Run(HalfPass(), pattern, &map, control_);
    result.half = map;
    map.visits = MadeUpVisits(width, height);
    for (size_t i = 0; i < map.planes.size(); i += 4)
      map.planes[i].distance = 0;
    map.Touch();
    backend->Run(HalfSearch(), pattern, &map, control_);
    map.visits = {};
    result.last = map;
    result.photometric_filter =
        backend->ConsistentViews(result.prior, kFilter, false, control_);
    result.geometric_filter =
        backend->ConsistentViews(result.geometric, kFilter, true, control_);
    result.num_evaluations = backend->num_cost_evaluations();
    return result;
  }

  void ExpectSameBytes(const Result& a, const Result& b) {
    EXPECT_TRUE(SameMaps(a.basic, b.basic));
    EXPECT_TRUE(SameMaps(a.prior, b.prior));
    EXPECT_TRUE(SameMaps(a.geometric, b.geometric));
    EXPECT_TRUE(SameMaps(a.half, b.half));
    EXPECT_TRUE(SameMaps(a.last, b.last));
    EXPECT_EQ(a.photometric_filter, b.photometric_filter);
    EXPECT_EQ(a.geometric_filter, b.geometric_filter);
    EXPECT_EQ(a.num_evaluations, b.num_evaluations);
  }

  const ViewSet views_ = MakeViews("sphere", kWidth, kHeight);
  const SamplingPattern nesp_ = MakeSamplingPattern(true, true);
  CancelToken cancel_;
  RunControl control_ = {&cancel_, nullptr};
};

struct Shape {
  int log_tile_width, rows_per_band;
};
class EveryShape : public EmulationTest,
                   public testing::WithParamInterface<Shape> {};
// Tiles of every width, bands that fit the tiles and bands that do not.
INSTANTIATE_TEST_SUITE_P(Emulation,
                         EveryShape,
                         testing::Values(Shape{3, 1000},
                                         Shape{1, 16},
                                         Shape{2, 3},
                                         Shape{4, 7},
                                         Shape{5, 5},
                                         Shape{6, 1}),
                         [](const auto& test) {
                           return "Tile" +
                                  std::to_string(test.param.log_tile_width) +
                                  "Band" +
                                  std::to_string(test.param.rows_per_band);
                         });

// Everything but the matching cost, byte by byte: tables, sweeps, keys, tiles,
// bands, window, geometric term, median, filter.
TEST_P(EveryShape, GivesTheBytesOfTheScalarCpuBackend) {
  EmulatedBackend emulated({EmulatedCost::kCore,
                            GetParam().log_tile_width,
                            GetParam().rows_per_band});
  const auto cpu = MakeCpuBackend("scalar", 2);
  const Result expected = RunAll(cpu.get(), views_, nesp_);
  ExpectSameBytes(RunAll(&emulated, views_, nesp_), expected);
  EXPECT_GT(expected.num_evaluations, 100u * kWidth * kHeight);
}

TEST_F(EmulationTest, GivesTheBytesOfTheCpuBackendWithTheLocalPattern) {
  const SamplingPattern local = MakeSamplingPattern(false, false);
  EmulatedBackend emulated({EmulatedCost::kCore, 3, 16});
  const auto cpu = MakeCpuBackend("scalar", 2);
  ExpectSameBytes(RunAll(&emulated, views_, local),
                  RunAll(cpu.get(), views_, local));
}

// A start where nothing is stored, and the score of planes.
TEST_F(EmulationTest, PartialStartsAndScoresGiveTheBytesOfTheCpuBackend) {
  EmulatedBackend emulated({EmulatedCost::kCore, 3, 16});
  const auto cpu = MakeCpuBackend("scalar", 2);
  const CancelToken cancel;
  std::vector<Result> results;
  for (Backend* backend : {static_cast<Backend*>(&emulated), cpu.get()}) {
    HypothesisMap map(views_.ref.camera.width, views_.ref.camera.height);
    backend->SetViews(views_, MethodParams());
    const SamplingPattern pattern = MakeSamplingPattern(true, true);
    backend->Run(kBasic, pattern, &map, {&cancel, nullptr});
    for (size_t i = 0; i < map.planes.size(); i += 3)
      map.planes[i].distance = 0;
    backend->Run({PassKind::kBasic, StartFrom::kMissing, 1, 5},
                 pattern,
                 &map,
                 {&cancel, nullptr});
    for (const Plane& plane : map.planes) ASSERT_GT(plane.distance, 0);
    std::vector<PixelPlane> planes;
    for (int i = 0; i < 500; ++i) {
      planes.push_back({i % map.width,
                        i % map.height,
                        map.planes[map.planes.size() - 1 - i]});
    }
    map.costs = backend->Score(planes, {&cancel, nullptr});
    results.emplace_back();
    results.back().basic = std::move(map);
    results.back().num_evaluations = backend->num_cost_evaluations();
  }
  ExpectSameBytes(results[0], results[1]);
}

TEST_F(EmulationTest, WholeRunsGiveTheBytesOfTheCpuBackend) {
  ExpectWholeRunsOfTheScalarCpuBackend([] {
    return std::make_unique<EmulatedBackend>(
        EmulationOptions{EmulatedCost::kCore, 3, 16});
  });
}

double MeanCost(const HypothesisMap& map) {
  double sum = 0;
  for (const float cost : map.costs) sum += cost;
  return sum / static_cast<double>(map.costs.size());
}

class EveryCost : public EmulationTest,
                  public testing::WithParamInterface<EmulatedCost> {};
INSTANTIATE_TEST_SUITE_P(Emulation,
                         EveryCost,
                         testing::Values(EmulatedCost::kQuad,
                                         EmulatedCost::kTexture),
                         [](const auto& test) {
                           return test.param == EmulatedCost::kQuad ? "Quad"
                                                                    : "Texture";
                         });

TEST_P(EveryCost, MapsAreThoseOfTheCpuButForTies) {
  for (const char* scene : {"sphere", "depth_step", "tilted_plane"}) {
    const ViewSet views = MakeViews(scene, 96, 72);
    EmulatedBackend emulated({GetParam(), 3, 16});
    const auto cpu = MakeCpuBackend("scalar", 2);
    const Result a = RunAll(&emulated, views, nesp_);
    const Result b = RunAll(cpu.get(), views, nesp_);
    const double basic = DifferingShare(a.basic, b.basic, views.ref.camera);
    const double geometric =
        DifferingShare(a.geometric, b.geometric, views.ref.camera);
    RecordProperty(std::string(scene) + "_basic_permille",
                   static_cast<int>(1000 * basic));
    RecordProperty(std::string(scene) + "_geometric_permille",
                   static_cast<int>(1000 * geometric));
    std::printf("%s: basic %.4f, geometric %.4f\n", scene, basic, geometric);
    EXPECT_LT(basic, 0.1) << scene;
    EXPECT_LT(geometric, 0.08) << scene;
    EXPECT_NEAR(MeanCost(a.geometric), MeanCost(b.geometric), 0.01) << scene;
  }
}

}  // namespace
}  // namespace hpm
