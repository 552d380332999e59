#include "tests/engine/estimate.h"

#include "src/engine/memory_stores.h"
#include "src/engine/run_schedule.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// All views are estimated until the last stage reads their maps.
class FirstMaps : public MemoryMapStore {
 public:
  FirstMaps(const RunSpec& spec, int num_final)
      : MemoryMapStore(spec.problems),
        last_stage_(static_cast<int>(spec.schedule.stages.size()) - 1),
        num_final_(num_final) {}
  bool IsNeeded(int stage, int problem) const override {
    return stage < last_stage_ || problem < num_final_;
  }

 private:
  const int last_stage_, num_final_;
};

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle =
      values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

RunSpec SceneSpec(const std::vector<RenderedView>& views,
                  const ScheduleOptions& options) {
  RunSpec spec;
  spec.schedule = MakeSchedule(options);
  spec.params = DefaultParams(FindMethod(options.method));
  for (size_t i = 0; i < views.size(); ++i) {
    const auto [nearest, furthest] = std::minmax_element(
        views[i].truth.depth.begin(), views[i].truth.depth.end());
    Problem problem;
    problem.image = static_cast<int>(i);
    problem.camera = views[i].camera;
    problem.depth_min = 0.7f * *nearest;
    problem.depth_max = 1.3f * *furthest;
    problem.random_key = i;
    for (size_t j = 0; j < views.size(); ++j) {
      if (j != i)
        problem.sources.push_back({static_cast<int>(j), views[j].camera, 0});
    }
    spec.problems.push_back(std::move(problem));
  }
  return spec;
}

std::vector<HypothesisMap> EstimateScene(WorkerPool* workers,
                                         const std::vector<RenderedView>& views,
                                         const RunSpec& spec,
                                         int num_final) {
  std::vector<GrayImage> pictures;
  for (const RenderedView& view : views)
    pictures.push_back({view.camera.width, view.camera.height, view.grey});
  MemoryImageStore images(std::move(pictures));
  FirstMaps store(spec, num_final);
  RunSchedule(spec, &images, &store, workers, {});
  std::vector<HypothesisMap> maps;
  for (int i = 0; i < num_final; ++i) maps.push_back(*store.map(i));
  return maps;
}

std::vector<HypothesisMap> EstimateScene(WorkerPool* workers,
                                         const std::vector<RenderedView>& views,
                                         const ScheduleOptions& options,
                                         int num_final) {
  return EstimateScene(workers, views, SceneSpec(views, options), num_final);
}

MapErrors MeasureErrors(const HypothesisMap& map, const RenderedView& truth) {
  std::vector<double> depth_errors, angles;
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const size_t at = static_cast<size_t>(row) * map.width + col;
      const float true_depth = truth.truth.depth[at];
      if (true_depth <= 0) continue;
      const Plane& plane = map.planes[at];
      const float depth = DepthAt(truth.camera,
                                  plane,
                                  static_cast<float>(col),
                                  static_cast<float>(row));
      depth_errors.push_back(std::abs(depth / true_depth - 1));
      const Vec3f& normal = truth.truth.normals[at];
      angles.push_back(std::atan2(Norm(Cross(plane.normal, normal)),
                                  Dot(plane.normal, normal)) *
                       180 / M_PI);
    }
  }
  return {Median(depth_errors), Median(angles)};
}

void ExpectSound(const HypothesisMap& map, const Camera& camera) {
  ASSERT_EQ(map.width, camera.width);
  ASSERT_EQ(map.height, camera.height);
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      const size_t at = static_cast<size_t>(row) * map.width + col;
      const Plane& plane = map.planes[at];
      const float x = static_cast<float>(col), y = static_cast<float>(row);
      ASSERT_NEAR(Norm(plane.normal), 1, 1e-4) << col << ", " << row;
      ASSERT_LT(Dot(plane.normal, RayAt(camera, x, y)), 0)
          << col << ", " << row;
      ASSERT_TRUE(std::isfinite(plane.distance)) << col << ", " << row;
      ASSERT_GT(DepthAt(camera, plane, x, y), 0) << col << ", " << row;
      ASSERT_TRUE(std::isfinite(DepthAt(camera, plane, x, y)));
      ASSERT_GE(map.costs[at], 0) << col << ", " << row;
      ASSERT_TRUE(std::isfinite(map.costs[at])) << col << ", " << row;
    }
  }
}

}  // namespace hpm
