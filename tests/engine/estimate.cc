#include "tests/engine/estimate.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include <gtest/gtest.h>

namespace hpm {
namespace {

std::shared_ptr<const InverseDepthMap> InverseDepth(const HypothesisMap& map,
                                                    const Camera& camera) {
  std::vector<float> inverse;
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      inverse.push_back(1 / DepthAt(camera,
                                    map.planes[inverse.size()],
                                    static_cast<float>(col),
                                    static_cast<float>(row)));
    }
  }
  return std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
}

double Median(std::vector<double> values) {
  if (values.empty()) return NAN;
  const auto middle =
      values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

View AsView(const RenderedView& rendered) {
  return {rendered.camera,
          std::make_shared<const GrayImage>(GrayImage{
              rendered.camera.width, rendered.camera.height, rendered.grey}),
          nullptr};
}

std::vector<HypothesisMap> EstimateScene(Backend* backend,
                                         const std::vector<RenderedView>& views,
                                         const ScheduleOptions& options,
                                         int num_final) {
  std::vector<Problem> problems;
  for (size_t i = 0; i < views.size(); ++i) {
    const auto [nearest, furthest] = std::minmax_element(
        views[i].truth.depth.begin(), views[i].truth.depth.end());
    Problem problem;
    problem.views.ref = AsView(views[i]);
    problem.views.depth_min = 0.7f * *nearest;
    problem.views.depth_max = 1.3f * *furthest;
    problem.views.random_key = i;
    for (size_t j = 0; j < views.size(); ++j) {
      if (j == i) continue;
      problem.sources.push_back(static_cast<int>(j));
      problem.views.srcs.push_back(AsView(views[j]));
    }
    problems.push_back(std::move(problem));
  }
  return EstimateProblems(backend, std::move(problems), options, num_final);
}

std::vector<HypothesisMap> EstimateProblems(Backend* backend,
                                            std::vector<Problem> problems,
                                            const ScheduleOptions& options,
                                            int num_final) {
  const Schedule schedule = MakeSchedule(options);
  const CancelToken cancel;
  const RunControl control = {&cancel, nullptr};
  PhaseTimes times;
  std::vector<HypothesisMap> maps;
  for (const Problem& problem : problems) {
    const Camera& camera = problem.views.ref.camera;
    maps.emplace_back(camera.width, camera.height);
  }
  for (const StageSpec& stage : schedule.stages) {
    const bool last = &stage == &schedule.stages.back();
    std::vector<HypothesisMap> next = maps;
    for (size_t i = 0; i < problems.size(); ++i) {
      if (last && static_cast<int>(i) >= num_final) break;
      ViewSet& views = problems[i].views;
      for (size_t k = 0; k < views.srcs.size(); ++k) {
        if (!stage.geometric) continue;
        views.srcs[k].inverse_depth =
            InverseDepth(maps[problems[i].sources[k]], views.srcs[k].camera);
      }
      RunStage(backend,
               views,
               schedule,
               stage,
               DefaultParams(FindMethod(options.method)),
               control,
               &next[i],
               &times);
    }
    maps = std::move(next);
  }
  maps.resize(num_final);
  return maps;
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
