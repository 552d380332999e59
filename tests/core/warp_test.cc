#include "src/core/warp.h"

#include "tests/core/test_cameras.h"

#include <functional>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// Calls check(ref, src, plane, col, row) for random pairs of cameras that
// differ in size, focal length and roll, with planes some five units away.
void ForRandomPairs(
    const std::function<
        void(const Camera&, const Camera&, const Plane&, int, int)>& check) {
  Random random(11);
  for (int i = 0; i < 300; ++i) {
    const Camera ref = RandomCamera(&random);
    const Camera src = RandomCamera(&random);
    const int col = static_cast<int>(random() % ref.width);
    const int row = static_cast<int>(random() % ref.height);
    const float x = static_cast<float>(col), y = static_cast<float>(row);
    const Vec3f normal = RandomFacingNormal(&random);
    if (Dot(normal, RayAt(ref, x, y)) > -0.2f) continue;
    const auto depth = static_cast<float>(UniformIn(&random, 4, 7));
    check(ref, src, PlaneFromDepth(ref, x, y, depth, normal), col, row);
  }
}

TEST(Warp, AgreesWithProjectingPointsOfThePlane) {
  int num_checked = 0;
  ForRandomPairs([&](const Camera& ref,
                     const Camera& src,
                     const Plane& plane,
                     int col,
                     int row) {
    const PatchWarp warp = WarpPatch(MakeViewWarp(ref, src),
                                     SlopeOf(ref, plane),
                                     static_cast<float>(col),
                                     static_cast<float>(row));
    for (int j = -5; j <= 5; j += 5) {
      for (int i = -5; i <= 5; i += 5) {
        const Eigen::Vector3d point = PointOn(ref, plane, col + i, row + j);
        const Eigen::Vector3d expected = ProjectInto(src, InWorld(ref, point));
        if (point.z() < 0 || expected.z() < 1) continue;
        const Vec3f q = warp.origin + static_cast<float>(i) * warp.dcol +
                        static_cast<float>(j) * warp.drow;
        EXPECT_NEAR(q.x / q.z, expected.x(), 2e-3);
        EXPECT_NEAR(q.y / q.z, expected.y(), 2e-3);
        ++num_checked;
      }
    }
  });
  EXPECT_GT(num_checked, 1500);
}

// So its sign tells whether the point is in front of the source camera.
TEST(Warp, ThirdComponentIsTheRatioOfDepths) {
  ForRandomPairs([](const Camera& ref,
                    const Camera& src,
                    const Plane& plane,
                    int col,
                    int row) {
    const Eigen::Vector3d point = PointOn(ref, plane, col, row);
    const PatchWarp warp = WarpPatch(MakeViewWarp(ref, src),
                                     SlopeOf(ref, plane),
                                     static_cast<float>(col),
                                     static_cast<float>(row));
    EXPECT_NEAR(warp.origin.z,
                ProjectInto(src, InWorld(ref, point)).z() / point.z(),
                1e-5);
  });
}

TEST(Warp, PointBehindTheSourceHasNegativeThirdComponent) {
  const Camera ref = MakeTestCamera(100, 80, 100, 0, {0, 0, 0});
  const Camera src = MakeTestCamera(100, 80, 100, 0, {0, 0, 6});
  const Plane plane = PlaneFromDepth(ref, 50, 40, 5, {0, 0, -1});
  EXPECT_LT(
      WarpPatch(MakeViewWarp(ref, src), SlopeOf(ref, plane), 50, 40).origin.z,
      0);
}

TEST(Warp, SlopeIsMinusTheInverseDepth) {
  ForRandomPairs([](const Camera& ref,
                    const Camera&,
                    const Plane& plane,
                    int col,
                    int row) {
    const PlaneSlope m = SlopeOf(ref, plane);
    for (const int dcol : {0, 7, -30}) {
      const double z = PointOn(ref, plane, col + dcol, row).z();
      EXPECT_NEAR(m.col * static_cast<float>(col + dcol) +
                      m.row * static_cast<float>(row) + m.constant,
                  -1 / z,
                  1e-5);
    }
  });
}

TEST(Warp, WarpingBackAlongTheSamePlaneGivesTheSamePixel) {
  ForRandomPairs([](const Camera& ref,
                    const Camera& src,
                    const Plane& plane,
                    int col,
                    int row) {
    // The plane in the source's frame.
    const Mat3f R = src.R * Transposed(ref.R);
    const Vec3f t = src.t - R * ref.t;
    Plane there = {R * plane.normal, 0};
    there.distance = plane.distance - Dot(there.normal, t);
    if (there.distance < 0.5f) return;
    const float x = static_cast<float>(col), y = static_cast<float>(row);
    const Vec3f q =
        WarpPatch(MakeViewWarp(ref, src), SlopeOf(ref, plane), x, y).origin;
    const Vec3f back =
        WarpPatch(
            MakeViewWarp(src, ref), SlopeOf(src, there), q.x / q.z, q.y / q.z)
            .origin;
    EXPECT_NEAR(back.x / back.z, x, 5e-3);
    EXPECT_NEAR(back.y / back.z, y, 5e-3);
  });
}

TEST(Warp, SameCameraIsTheIdentityForEveryPlane) {
  Random random(5);
  const Camera camera = RandomCamera(&random);
  const ViewWarp view = MakeViewWarp(camera, camera);
  for (int i = 0; i < 20; ++i) {
    const Plane plane =
        PlaneFromDepth(camera, 20, 30, 3, RandomFacingNormal(&random));
    const PatchWarp warp = WarpPatch(view, SlopeOf(camera, plane), 20, 30);
    EXPECT_NEAR(warp.origin.x / warp.origin.z, 20, 1e-3);
    EXPECT_NEAR(warp.origin.y / warp.origin.z, 30, 1e-3);
  }
}

}  // namespace
}  // namespace hpm
