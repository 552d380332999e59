#include "tests/core/test_cameras.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(Camera, WorldAndCameraFramesAreInverse) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = RandomCamera(&random);
    const Vec3f p = {static_cast<float>(UniformIn(&random, -2, 2)),
                     static_cast<float>(UniformIn(&random, -2, 2)),
                     static_cast<float>(UniformIn(&random, 1, 9))};
    const Vec3f in_camera = CamFromWorld(camera, p);
    EXPECT_LT((ToEigen(in_camera) - InCamera(camera, ToEigen(p))).norm(), 1e-5);
    EXPECT_LT(Norm(WorldFromCam(camera, in_camera) - p), 1e-5);
  }
}

TEST(Camera, CenterIsTheOriginOfTheCameraFrame) {
  const Camera camera =
      MakeTestCamera(64, 48, 50, 0.7, {0.3, -0.2, 0.9}, {0.1, 0.2, 0});
  EXPECT_LT(Norm(CamFromWorld(camera, Center(camera))), 1e-6);
  EXPECT_LT(Norm(Center(camera) - Vec3f{0.3f, -0.2f, 0.9f}), 1e-6);
}

TEST(Camera, RayAtProjectsBackToItsPixel) {
  Random random(2);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = RandomCamera(&random);
    const double col = UniformIn(&random, -5, camera.width + 5);
    const double row = UniformIn(&random, -5, camera.height + 5);
    const Vec3f ray =
        RayAt(camera, static_cast<float>(col), static_cast<float>(row));
    EXPECT_EQ(ray.z, 1.0f);
    const Eigen::Vector3d pixel =
        ProjectInto(camera, InWorld(camera, 7 * ToEigen(ray)));
    EXPECT_NEAR(pixel.x(), col, 1e-3);
    EXPECT_NEAR(pixel.y(), row, 1e-3);
  }
}

// Pixel x of a level covers the full-size pixels from x * 2^level on.
TEST(LevelCamera, KeepsPointsUnderTheSameBlockOfPixels) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = RandomCamera(&random);
    for (int level = 0; level <= 3; ++level) {
      const Camera small = LevelCamera(camera, level);
      const int factor = 1 << level;
      const Eigen::Vector3d point =
          InWorld(camera, {UniformIn(&random, -1, 1), 0.4, 5});
      const Eigen::Vector3d full = ProjectInto(camera, point);
      const Eigen::Vector3d half = ProjectInto(small, point);
      EXPECT_NEAR((half.x() + 0.5) * factor - 0.5, full.x(), 1e-3);
      EXPECT_NEAR((half.y() + 0.5) * factor - 0.5, full.y(), 1e-3);
      EXPECT_GE(small.width * factor, camera.width);
      EXPECT_LT((small.width - 1) * factor, camera.width);
      EXPECT_GE(small.height * factor, camera.height);
      EXPECT_LT((small.height - 1) * factor, camera.height);
    }
  }
}

TEST(Plane, FromDepthAndBackIsExactToRounding) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const Camera camera = RandomCamera(&random);
    const float col = static_cast<float>(random() % camera.width);
    const float row = static_cast<float>(random() % camera.height);
    const float depth = static_cast<float>(UniformIn(&random, 0.01, 100));
    const Vec3f normal = RandomFacingNormal(&random);
    if (Dot(normal, RayAt(camera, col, row)) > -0.1f) continue;
    const Plane plane = PlaneFromDepth(camera, col, row, depth, normal);
    EXPECT_NEAR(DepthAt(camera, plane, col, row) / depth, 1, 1e-6);
    EXPECT_GT(plane.distance, 0);
  }
}

TEST(Plane, DepthsElsewhereLieOnThePlane) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Camera camera = RandomCamera(&random);
    const Plane plane =
        PlaneFromDepth(camera, 40, 30, 5, RandomFacingNormal(&random));
    for (const float col : {0.0f, 33.5f, 99.0f}) {
      const float z = DepthAt(camera, plane, col, 12);
      const Vec3f point = z * RayAt(camera, col, 12);
      EXPECT_NEAR(
          (Dot(plane.normal, point) + plane.distance) / std::abs(z), 0, 1e-5);
    }
  }
}

TEST(Plane, DepthBehindTheCameraIsNegative) {
  const Camera camera = MakeTestCamera(100, 100, 50, 0, {0, 0, 0});
  const Plane steep = PlaneFromDepth(camera, 50, 50, 1, Normalized({5, 0, -1}));
  EXPECT_LT(DepthAt(camera, steep, 99, 50), 0);
}

}  // namespace
}  // namespace hpm
