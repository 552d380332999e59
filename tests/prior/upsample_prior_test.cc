#include "src/prior/upsample_prior.h"

#include "src/core/upsample_plane.h"
#include "tests/prior/prior_scene.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr PriorRange kRange = {0.5f, 50.0f};

GrayImage Constant(int width, int height, uint8_t value) {
  GrayImage image;
  image.width = width;
  image.height = height;
  image.data.assign(static_cast<size_t>(width) * height, value);
  return image;
}

std::vector<Plane> Upsampled(const std::vector<Plane>& planes,
                             int level,
                             const Camera& camera,
                             const GrayImage& guide,
                             const PriorRange& range) {
  std::vector<Plane> result(7, TiltedPlane());  // of another map
  UpsamplePrior(planes, level, camera, guide, range, &result);
  return result;
}

// The weights looked up are those computed.
TEST(UpsamplePrior, IsWhatEachPixelGivesAlone) {
  const Camera camera = PriorCamera(50, 34);
  for (int level = 1; level < 4; ++level) {
    const Camera low = LevelCamera(camera, level);
    std::vector<Plane> planes(static_cast<size_t>(low.width) * low.height,
                              TiltedPlane());
    for (size_t i = 0; i < planes.size(); ++i)
      planes[i].distance *= 1 + 0.01f * static_cast<float>(i % 7);
    GrayImage guide = Constant(camera.width, camera.height, 0);
    for (size_t i = 0; i < guide.data.size(); ++i)
      guide.data[i] = static_cast<uint8_t>(50 + i * 37 % 64);
    const std::vector<Plane> full =
        Upsampled(planes, level, camera, guide, kRange);
    for (int row = 0; row < camera.height; ++row) {
      for (int col = 0; col < camera.width; ++col) {
        const Plane alone = UpsamplePlaneAt(
            planes.data(),
            level,
            camera,
            [&](int c, int r) { return guide.at(c, r); },
            UpsampleSpatialWeight,
            UpsampleColorWeight,
            kRange.depth_min,
            kRange.depth_max,
            col,
            row);
        EXPECT_EQ(full[static_cast<size_t>(row) * camera.width + col].distance,
                  alone.distance);
      }
    }
  }
}

TEST(UpsamplePrior, ASlantedPlaneStaysExact) {
  const Camera camera = PriorCamera(50, 34);
  for (int level = 1; level <= 2; ++level) {
    const Camera low = LevelCamera(camera, level);
    const std::vector<Plane> planes(static_cast<size_t>(low.width) * low.height,
                                    TiltedPlane());
    const std::vector<Plane> full =
        Upsampled(planes, level, camera, Constant(50, 34, 90), kRange);
    for (int row = 0; row < 34; ++row) {
      for (int col = 0; col < 50; ++col) {
        ASSERT_GT(full[row * 50 + col].distance, 0);
        EXPECT_NEAR(DepthDifference(
                        camera, full[row * 50 + col], TiltedPlane(), col, row),
                    0,
                    1e-5f);
      }
    }
  }
}

TEST(UpsamplePrior, NormalsAreUnitWhereEveryTapHasAnotherGrey) {
  const Camera camera = PriorCamera(50, 34);
  const Camera low = LevelCamera(camera, 1);
  // Taps are read at odd pixels of odd rows.
  GrayImage guide = Constant(50, 34, 0);
  for (int row = 1; row < 34; row += 2) {
    for (int col = 1; col < 50; col += 2) guide.data[row * 50 + col] = 255;
  }
  const std::vector<Plane> planes(static_cast<size_t>(low.width) * low.height,
                                  TiltedPlane());
  for (const Plane& plane : Upsampled(planes, 1, camera, guide, kRange)) {
    ASSERT_GT(plane.distance, 0);
    EXPECT_NEAR(Norm(plane.normal), 1, 1e-5f);
  }
}

TEST(UpsamplePrior, ADepthStepFollowsTheGuide) {
  const Camera camera = PriorCamera(32, 16);
  GrayImage guide = Constant(32, 16, 20);
  const int edge = 13;  // not on the grid of level 2
  for (int row = 0; row < 16; ++row) {
    for (int col = edge; col < 32; ++col) guide.data[row * 32 + col] = 220;
  }
  const Camera low = LevelCamera(camera, 2);
  const Plane near_plane = {{0, 0, -1}, 3.0f}, far_plane = {{0, 0, -1}, 6.0f};
  std::vector<Plane> planes;
  for (int i = 0; i < low.width * low.height; ++i) {
    planes.push_back(i % low.width < 3 ? near_plane : far_plane);
  }
  const std::vector<Plane> full = Upsampled(planes, 2, camera, guide, kRange);
  for (int col = 0; col < 32; ++col) {
    const float z =
        DepthAt(camera, full[8 * 32 + col], static_cast<float>(col), 8);
    EXPECT_NEAR(z, col < edge ? 3.0f : 6.0f, 0.05f) << "column " << col;
  }
}

TEST(UpsamplePrior, MissingTapsAreSkippedAndEmptyMapsStayEmpty) {
  const Camera camera = PriorCamera(16, 16);
  std::vector<Plane> planes(64, Plane{{0, 0, 0}, 0});
  for (const Plane& plane :
       Upsampled(planes, 1, camera, Constant(16, 16, 50), kRange)) {
    EXPECT_EQ(plane.distance, 0);
  }
  planes[4 * 8 + 4] = TiltedPlane();
  const std::vector<Plane> full =
      Upsampled(planes, 1, camera, Constant(16, 16, 50), kRange);
  EXPECT_NEAR(
      DepthDifference(camera, full[9 * 16 + 9], TiltedPlane(), 9, 9), 0, 1e-5f);
  EXPECT_EQ(full[0].distance, 0);
}

}  // namespace
}  // namespace hpm
