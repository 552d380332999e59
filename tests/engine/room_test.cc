// A room whose back wall has next to no texture, from the truth: what each of
// the methods is for. A bound lies between what the method reaches and what is
// left without the part that makes it: shares of the back wall's pixels whose
// depth is right within 2 %.
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

class Room : public testing::Test {
 protected:
  Room() : scene_(MakeRoom(Size())), views_(RenderViews(scene_, 3)) {}

  static SceneOptions Size() {
    SceneOptions size;
    size.num_views = 6;
    size.width = 160;
    size.height = 120;
    return size;
  }

  // Of the back wall's pixels in the first maps.
  double RightShare(const std::string& method, bool with_regions = true) {
    ScheduleOptions options;
    options.method = method;
    options.num_levels = 2;
    RunSpec spec = SceneSpec(views_, options);
    if (!with_regions) spec.params.weak_gradient = 0;
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
          if (!hit || hit->point.z() < kBackWall) continue;
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
    RecordProperty(
        method + (with_regions ? "" : "_without_regions") + "_permille",
        static_cast<int>(1000 * share));
    return share;
  }

  const TestScene scene_;
  const std::vector<RenderedView> views_;
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

}  // namespace
}  // namespace hpm
