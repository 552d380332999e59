// Whole methods against closed-form truth.
#include "src/cpu/cpu_backend.h"
#include "src/cpu/match_cost.h"
#include "tests/engine/estimate.h"

#include <string>
#include <tuple>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// Median errors that are allowed. The scenes look the same at every size, so
// the relative depth error of a given error in pixels falls with the width.
constexpr double kMaxDepthError = 0.001 * 160;  // relative, times pixels
constexpr double kMaxNormalError = 3;           // degrees

SceneOptions Size(int width, int height, int num_views) {
  SceneOptions options;
  options.width = width;
  options.height = height;
  options.num_views = num_views;
  return options;
}

ScheduleOptions Method(const std::string& name, int num_geom_passes) {
  ScheduleOptions options;
  options.method = name;
  options.num_geom_passes = num_geom_passes;
  return options;
}

void ExpectAccurate(const std::string& target,
                    const std::string& scene,
                    const SceneOptions& size,
                    const ScheduleOptions& method) {
  const std::vector<RenderedView> views =
      RenderViews(MakeScene(scene, size), 3);
  const auto backend = MakeCpuBackend(target, 2);
  const HypothesisMap map = EstimateScene(backend.get(), views, method, 1)[0];
  ExpectSound(map, views[0].camera);
  const MapErrors errors = MeasureErrors(map, views[0]);
  EXPECT_LT(errors.depth, kMaxDepthError / size.width)
      << target << ", " << scene;
  EXPECT_LT(errors.normal, kMaxNormalError) << target << ", " << scene;
  testing::Test::RecordProperty("depth_error_ppm",
                                static_cast<int>(1e6 * errors.depth));
  testing::Test::RecordProperty("normal_error_millidegrees",
                                static_cast<int>(1e3 * errors.normal));
}

std::vector<std::string> SimdTargets() {
  std::vector<std::string> names;
  for (const CpuTarget& target : CpuTargets()) {
    if (target.name != "scalar") names.push_back(target.name);
  }
  return names;
}

using SceneAndTarget = std::tuple<std::string, std::string>;
class EverySceneOnEveryTarget : public testing::TestWithParam<SceneAndTarget> {
};
INSTANTIATE_TEST_SUITE_P(
    Accuracy,
    EverySceneOnEveryTarget,
    testing::Combine(testing::Values("tilted_plane", "depth_step", "sphere"),
                     testing::ValuesIn(SimdTargets())),
    [](const auto& test) {
      return std::get<0>(test.param) + "_" + std::get<1>(test.param);
    });

TEST_P(EverySceneOnEveryTarget, NespWithGeometricPassesIsAccurate) {
  const auto& [scene, target] = GetParam();
  ExpectAccurate(target, scene, Size(160, 120, 7), Method("nesp", 2));
}

// Small enough for the readable target and for emulators.
class SmallScene : public testing::TestWithParam<CpuTarget> {};
INSTANTIATE_TEST_SUITE_P(Accuracy,
                         SmallScene,
                         testing::ValuesIn(CpuTargets()),
                         [](const auto& test) { return test.param.name; });

TEST_P(SmallScene, IsAccurate) {
  ExpectAccurate(
      GetParam().name, "tilted_plane", Size(48, 36, 5), Method("nesp", 3));
}

}  // namespace
}  // namespace hpm
