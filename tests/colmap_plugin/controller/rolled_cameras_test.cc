// COLMAP takes integer pixels for pixel centres when it matches and when it
// fuses, while K of the sparse model has the centres at +0.5. Between cameras
// of one orientation the half pixel cancels nearly; between rolled ones it does
// not. Matching with true centres and writing for fusion's rays must.
#include "src/cpu/cpu_backend.h"
#include "tests/colmap_plugin/controller/written_maps.h"
#include "tests/engine/estimate.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kNumRefs = 3;      // one of each roll
constexpr double kDistance = 5;  // of the scene, world units

Camera SparseModelCamera(Camera camera) {
  camera.cx += 0.5f;
  camera.cy += 0.5f;
  return camera;
}

class RolledCameras : public testing::Test {
 protected:
  RolledCameras() {
    SceneOptions options;
    options.num_views = 6;
    options.width = 100;
    options.height = 100;
    options.quarter_turns = {0, 1, 2};
    scene_ = std::make_unique<TestScene>(MakeTiltedPlane(options));
    views_ = RenderViews(*scene_, 3);
  }

  std::vector<HypothesisMap> Estimate(const std::vector<RenderedView>& views) {
    ScheduleOptions options;
    options.method = "nesp";
    options.num_iterations = 3;
    options.num_geom_passes = 0;
    return EstimateScene(&workers_, views, options, kNumRefs);
  }

  // Distances to the true plane of the points that fusion makes of depth maps.
  std::vector<double> Distances(const std::vector<Map>& depths) const {
    const auto& plane = std::get<PlaneSurface>(scene_->surfaces[0]);
    std::vector<double> distances;
    for (size_t i = 0; i < depths.size(); ++i) {
      const Camera fusion = SparseModelCamera(scene_->cameras[i]);
      for (int row = 0; row < fusion.height; ++row) {
        for (int col = 0; col < fusion.width; ++col) {
          const float z =
              depths[i].data[static_cast<size_t>(row) * fusion.width + col];
          const Vec3f p = WorldFromCam(fusion,
                                       z * RayAt(fusion,
                                                 static_cast<float>(col),
                                                 static_cast<float>(row)));
          distances.push_back(std::abs(plane.normal.normalized().dot(
              Eigen::Vector3d(p.x, p.y, p.z) - plane.point)));
        }
      }
    }
    return distances;
  }

  static double Median(std::vector<double> values) {
    const auto middle =
        values.begin() + static_cast<ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  WorkerPool workers_{MakeCpuBackend("auto", 2)};
  std::unique_ptr<TestScene> scene_;
  std::vector<RenderedView> views_;
};

TEST_F(RolledCameras, FusedPointsAreMuchNearerThanWithTheIntegerRule) {
  const std::vector<HypothesisMap> maps = Estimate(views_);
  std::vector<Map> ours;
  for (int i = 0; i < kNumRefs; ++i) {
    ours.push_back(WrittenMaps(maps[i], views_[i].camera).depth);
  }

  std::vector<RenderedView> integer_views = views_;
  for (RenderedView& view : integer_views) {
    view.camera = SparseModelCamera(view.camera);
  }
  const std::vector<HypothesisMap> integer_maps = Estimate(integer_views);
  std::vector<Map> integer;
  for (int i = 0; i < kNumRefs; ++i) {
    const Camera& camera = integer_views[i].camera;
    Map depth = {camera.width, camera.height, 1, {}};
    for (int row = 0; row < camera.height; ++row) {
      for (int col = 0; col < camera.width; ++col) {
        depth.data.push_back(DepthAt(camera,
                                     integer_maps[i].planes[depth.data.size()],
                                     static_cast<float>(col),
                                     static_cast<float>(row)));
      }
    }
    integer.push_back(std::move(depth));
  }

  const double our_median = Median(Distances(ours));
  const double integer_median = Median(Distances(integer));
  RecordProperty("our_median_micro", static_cast<int>(1e6 * our_median));
  RecordProperty("integer_median_micro",
                 static_cast<int>(1e6 * integer_median));
  EXPECT_LT(our_median, 0.001 * kDistance);
  EXPECT_GT(integer_median, 5 * our_median);
}

}  // namespace
}  // namespace hpm
