// Rooms whose walls have next to no texture, from the truth: what each of the
// methods is for. A bound lies between what the method reaches and what is left
// without the part that makes it: shares of the walls' pixels whose depth is
// right within 2 %.
#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_stores.h"
#include "src/engine/run_schedule.h"
#include "tests/engine/estimate.h"

#include <cmath>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kNumMaps = 2;

SceneOptions SizeOf(int width, int height) {
  SceneOptions size;
  size.num_views = 6;
  size.width = width;
  size.height = height;
  return size;
}

class MethodsOnScene : public testing::Test {
 protected:
  explicit MethodsOnScene(const TestScene& scene)
      : scene_(scene), views_(RenderViews(scene_, 3)) {}

  RunSpec SpecOf(const std::string& method, int num_levels) const {
    ScheduleOptions options;
    options.method = method;
    options.num_levels = num_levels;
    return SceneSpec(views_, options);
  }

  // Of the pixels in the first maps that see what lies beyond this world z.
  double RightShare(const RunSpec& spec, double beyond, const char* name) {
    std::vector<GrayImage> pictures;
    for (const RenderedView& view : views_)
      pictures.push_back({view.camera.width, view.camera.height, view.grey});
    MemoryImageStore images(std::move(pictures));
    MemoryMapStore store(spec.problems);
    WorkerPool workers(MakeCpuBackend("auto", 2));
    RunSchedule(spec, &images, &store, &workers, {});
    int num_pixels = 0, num_right = 0;
    for (int i = 0; i < kNumMaps; ++i) {
      const Camera& camera = views_[i].camera;
      for (int row = 0; row < camera.height; ++row) {
        for (int col = 0; col < camera.width; ++col) {
          const auto hit = HitAt(scene_, camera, col, row);
          if (!hit || hit->point.z() < beyond) continue;
          const size_t at = static_cast<size_t>(row) * camera.width + col;
          const float depth = DepthAt(camera,
                                      store.map(i)->planes[at],
                                      static_cast<float>(col),
                                      static_cast<float>(row));
          ++num_pixels;
          num_right += std::abs(depth / views_[i].truth.depth[at] - 1) < 0.02;
        }
      }
    }
    const double share = num_right / static_cast<double>(num_pixels);
    RecordProperty(std::string(name) + "_permille",
                   static_cast<int>(1000 * share));
    return share;
  }

 private:
  const TestScene scene_;
  const std::vector<RenderedView> views_;
};

// Of the back wall.
class Room : public MethodsOnScene {
 protected:
  Room() : MethodsOnScene(MakeRoom(SizeOf(160, 120))) {}

  double RightShare(const std::string& method, bool with_regions = true) {
    RunSpec spec = SpecOf(method, 2);
    if (!with_regions) spec.params.weak_gradient = 0;
    return MethodsOnScene::RightShare(
        spec,
        kBackWall,
        (method + (with_regions ? "" : "_without_regions")).c_str());
  }
};

class Corridor : public MethodsOnScene {
 protected:
  Corridor() : MethodsOnScene(MakeCorridor(SizeOf(200, 150))) {}

  double RightShare(const RunSpec& spec, const char* name) {
    constexpr double kAnywhere = -100;
    return MethodsOnScene::RightShare(spec, kAnywhere, name);
  }
};

TEST_F(Room, NespReachesWhatTheLocalPatternDoesNot) {
  constexpr double kBound = 0.65;
  EXPECT_GT(RightShare("nesp"), kBound);
  EXPECT_LT(RightShare("acmh"), kBound);
}

TEST_F(Room, TrianglesOfCrediblePointsReachWhatNespAloneDoesNot) {
  constexpr double kBound = 0.74;
  EXPECT_GT(RightShare("hpm"), kBound);
  EXPECT_LT(RightShare("nesp"), kBound);
}

TEST_F(Room, PlanesOfRegionsReachWhatTrianglesDoNot) {
  constexpr double kBound = 0.85;
  EXPECT_GT(RightShare(kDefaultMethod), kBound);
  EXPECT_LT(RightShare("hpm"), kBound);
  EXPECT_LT(RightShare(kDefaultMethod, /*with_regions=*/false), kBound);
}

TEST_F(Corridor, TrianglesFindWallsThatNoPlaneExplains) {
  constexpr double kBound = 0.3;
  const RunSpec spec = SpecOf(kDefaultMethod, 1);
  EXPECT_GT(RightShare(spec, "default"), kBound);
  RunSpec without = spec;
  Pass& first = without.schedule.stages.at(1).passes.front();
  ASSERT_TRUE(first.triangles);
  first.triangles = false;
  EXPECT_LT(RightShare(without, "without_triangles"), kBound);
}

}  // namespace
}  // namespace hpm
