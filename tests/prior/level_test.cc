#include "src/prior/level.h"

#include "tests/prior/prior_scene.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(Level, CameraSeesTheSameRaysAtBlockCentres) {
  const Camera camera = PriorCamera(64, 48);
  for (int level = 0; level <= 3; ++level) {
    const Camera low = LevelCamera(camera, level);
    const float factor = static_cast<float>(1 << level);
    for (int col = 0; col < low.width; ++col) {
      const float x = (static_cast<float>(col) + 0.5f) * factor - 0.5f;
      EXPECT_NEAR(RayAt(low, static_cast<float>(col), 0).x,
                  RayAt(camera, x, 0).x,
                  1e-6f);
    }
  }
}

TEST(Level, PartialBlocksCountAsPixels) {
  const Camera low = LevelCamera(PriorCamera(65, 33), 2);
  EXPECT_EQ(low.width, 17);
  EXPECT_EQ(low.height, 9);
}

TEST(Level, DepthIsThatOfThePlaneAtTheBlockCentre) {
  const Camera camera = PriorCamera(64, 48);
  const HypothesisMap map = PlaneMap(camera, TiltedPlane(), 0.05f);
  for (int level = 0; level <= 2; ++level) {
    const LevelMap low = MakeLevel(map, camera, level);
    for (int row = 0; row < low.camera.height; ++row) {
      for (int col = 0; col < low.camera.width; ++col) {
        const float z = DepthAt(low.camera,
                                TiltedPlane(),
                                static_cast<float>(col),
                                static_cast<float>(row));
        EXPECT_NEAR(low.depths[row * low.camera.width + col], z, 1e-5f * z);
      }
    }
  }
}

TEST(Level, ThePixelOfSmallestCostSpeaksForTheBlock) {
  const Camera camera = PriorCamera(8, 8);
  HypothesisMap map = PlaneMap(camera, {{0, 0, -1}, 5.0f}, 0.5f);
  const size_t best = 3 * 8 + 2;
  map.costs[best] = 0.01f;
  map.planes[best].distance = 7.0f;
  const LevelMap low = MakeLevel(map, camera, 2);
  EXPECT_FLOAT_EQ(low.depths[0], 7.0f);
  EXPECT_FLOAT_EQ(low.costs[0], 0.01f);
  EXPECT_FLOAT_EQ(low.depths[1], 5.0f);
}

TEST(Level, PixelsWithoutHypothesisSayNothing) {
  const Camera camera = PriorCamera(4, 4);
  const LevelMap low = MakeLevel(HypothesisMap(4, 4), camera, 1);
  for (const float depth : low.depths) EXPECT_EQ(depth, 0.0f);
}

}  // namespace
}  // namespace hpm
