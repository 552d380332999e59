#include "src/prior/planar_prior.h"

#include "tests/prior/prior_scene.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr PriorRange kRange = {0.5f, 50.0f};

CrediblePoint PointOn(const Camera& camera,
                      const Plane& plane,
                      int col,
                      int row) {
  const float x = static_cast<float>(col), y = static_cast<float>(row);
  return {col, row, DepthAt(camera, plane, x, y) * RayAt(camera, x, y)};
}

std::vector<Plane> AsPublished(const Camera& camera,
                               const std::vector<CrediblePoint>& points,
                               const PriorRange& range = kRange) {
  return MakePlanarPrior(
      camera, points, range, OutsideTriangles::kNearestPoints);
}

// 5 x 3 points of the plane, of columns 20 to 40 and rows 15 to 25.
std::vector<CrediblePoint> GridInTheMiddle(const Camera& camera) {
  std::vector<CrediblePoint> points;
  for (int row = 15; row <= 25; row += 5) {
    for (int col = 20; col <= 40; col += 5) {
      points.push_back(PointOn(camera, TiltedPlane(), col, row));
    }
  }
  return points;
}

int CountPlanes(const std::vector<Plane>& planes) {
  int count = 0;
  for (const Plane& plane : planes) count += plane.distance > 0;
  return count;
}

TEST(PlanarPrior, TrianglesOfAPlaneGiveThePlane) {
  const Camera camera = PriorCamera(40, 30);
  std::vector<CrediblePoint> points;
  for (const auto& [col, row] :
       {std::pair(0, 0), {39, 0}, {0, 29}, {39, 29}, {17, 12}}) {
    points.push_back(PointOn(camera, TiltedPlane(), col, row));
  }
  const std::vector<Plane> planes = AsPublished(camera, points);
  EXPECT_EQ(CountPlanes(planes), 40 * 30);
  for (int row = 0; row < 30; ++row) {
    for (int col = 0; col < 40; ++col) {
      const Plane& plane = planes[row * 40 + col];
      EXPECT_NEAR(
          DepthDifference(camera, plane, TiltedPlane(), col, row), 0, 1e-4f);
      EXPECT_LT(Dot(plane.normal, RayAt(camera, col, row)), 0);
    }
  }
}

TEST(PlanarPrior, PixelsOutsideTheTrianglesGetTheNearestPoints) {
  const Camera camera = PriorCamera(60, 40);
  const std::vector<CrediblePoint> points = GridInTheMiddle(camera);
  const std::vector<Plane> planes = AsPublished(camera, points);
  EXPECT_EQ(CountPlanes(planes), 60 * 40);
  EXPECT_NEAR(
      DepthDifference(camera, planes[0], TiltedPlane(), 0, 0), 0, 2e-3f);
  EXPECT_NEAR(
      DepthDifference(camera, planes[60 * 40 - 1], TiltedPlane(), 59, 39),
      0,
      2e-3f);
}

TEST(PlanarPrior, PixelsOutsideTheTrianglesMayStayWithout) {
  const Camera camera = PriorCamera(60, 40);
  const std::vector<CrediblePoint> points = GridInTheMiddle(camera);
  const std::vector<Plane> planes =
      MakePlanarPrior(camera, points, kRange, OutsideTriangles::kNothing);
  EXPECT_EQ(CountPlanes(planes), 21 * 11);
  EXPECT_GT(planes[20 * 60 + 30].distance, 0);
}

TEST(PlanarPrior, FewerThanSixPointsReachOnlyTheirTriangles) {
  const Camera camera = PriorCamera(20, 20);
  std::vector<CrediblePoint> points;
  for (const auto& [col, row] : {std::pair(5, 5), {14, 5}, {5, 14}}) {
    points.push_back(PointOn(camera, TiltedPlane(), col, row));
  }
  // Half of a 10 x 10 square, its diagonal included.
  EXPECT_EQ(CountPlanes(AsPublished(camera, points)), 55);
}

TEST(PlanarPrior, DegeneratePointsGiveNoPlane) {
  const Camera camera = PriorCamera(20, 20);
  EXPECT_EQ(CountPlanes(AsPublished(camera, {})), 0);
  std::vector<CrediblePoint> collinear;
  for (int i = 0; i < 8; ++i) {
    collinear.push_back(PointOn(camera, TiltedPlane(), 2 * i, 2 * i));
  }
  EXPECT_EQ(CountPlanes(AsPublished(camera, collinear)), 0);
  const std::vector<CrediblePoint> repeated(
      8, PointOn(camera, TiltedPlane(), 3, 3));
  EXPECT_EQ(CountPlanes(AsPublished(camera, repeated)), 0);
}

TEST(PlanarPrior, PlanesOutsideTheDepthRangeAreDropped) {
  const Camera camera = PriorCamera(40, 30);
  std::vector<CrediblePoint> points;
  for (const auto& [col, row] : {std::pair(0, 0), {39, 0}, {0, 29}, {39, 29}}) {
    points.push_back(PointOn(camera, TiltedPlane(), col, row));
  }
  const PriorRange narrow = {3.5f, 4.0f};
  const std::vector<Plane> planes = AsPublished(camera, points, narrow);
  EXPECT_GT(CountPlanes(planes), 0);
  EXPECT_LT(CountPlanes(planes), 40 * 30);
  for (int i = 0; i < 40 * 30; ++i) {
    if (!(planes[i].distance > 0)) continue;
    const float z = DepthAt(camera,
                            planes[i],
                            static_cast<float>(i % 40),
                            static_cast<float>(i / 40));
    EXPECT_GE(z, narrow.depth_min);
    EXPECT_LE(z, narrow.depth_max);
  }
}

}  // namespace
}  // namespace hpm
