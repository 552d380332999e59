#include "src/prior/build_prior.h"

#include "tests/prior/prior_scene.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

// A wall of which only a frame is credible, and wrong hypotheses elsewhere.
TEST(BuildPrior, FillsAWallFromItsFrameAtEveryLevel) {
  const Camera camera = PriorCamera(96, 72);
  HypothesisMap map = PlaneMap(camera, {{0, 0, -1}, 9.0f}, 0.7f);
  for (int row = 0; row < 72; ++row) {
    for (int col = 0; col < 96; ++col) {
      if (row >= 12 && row < 60 && col >= 12 && col < 84) continue;
      map.planes[row * 96 + col] = TiltedPlane();
      map.costs[row * 96 + col] = 0.03f;
    }
  }
  GrayImage guide;
  guide.width = 96;
  guide.height = 72;
  guide.data.assign(96 * 72, 128);
  for (int level = 0; level <= 2; ++level) {
    const std::vector<Plane> prior =
        BuildPrior(map, camera, guide, level, {0.5f, 50.0f});
    for (int row = 0; row < 72; ++row) {
      for (int col = 0; col < 96; ++col) {
        ASSERT_GT(prior[row * 96 + col].distance, 0);
        EXPECT_NEAR(DepthDifference(
                        camera, prior[row * 96 + col], TiltedPlane(), col, row),
                    0,
                    2e-3f)
            << "level " << level << " pixel " << col << " " << row;
      }
    }
  }
}

}  // namespace
}  // namespace hpm
