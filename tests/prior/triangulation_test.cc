#include "src/prior/triangulation.h"

#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

namespace hpm {
namespace {

CrediblePoint At(int col, int row) { return {col, row, {0, 0, 1}}; }

int64_t DoubledArea(const std::vector<CrediblePoint>& p,
                    const std::array<int, 3>& t) {
  return std::llabs(static_cast<int64_t>(p[t[1]].col - p[t[0]].col) *
                        (p[t[2]].row - p[t[0]].row) -
                    static_cast<int64_t>(p[t[1]].row - p[t[0]].row) *
                        (p[t[2]].col - p[t[0]].col));
}

TEST(Triangulation, FewerThanThreePointsHaveNoTriangles) {
  EXPECT_TRUE(Triangulate({}, 10, 10).empty());
  EXPECT_TRUE(Triangulate({At(1, 1)}, 10, 10).empty());
  EXPECT_TRUE(Triangulate({At(1, 1), At(5, 5)}, 10, 10).empty());
}

TEST(Triangulation, CollinearPointsHaveNoTriangles) {
  EXPECT_TRUE(
      Triangulate({At(0, 0), At(2, 2), At(4, 4), At(9, 9)}, 10, 10).empty());
}

TEST(Triangulation, RepeatedPointsCountOnce) {
  const std::vector<CrediblePoint> points = {
      At(0, 0), At(9, 0), At(0, 9), At(9, 0), At(0, 0)};
  ASSERT_EQ(Triangulate(points, 10, 10).size(), 1u);
}

TEST(Triangulation, CornersOfTheImageAreCovered) {
  const std::vector<CrediblePoint> points = {
      At(0, 0), At(9, 0), At(0, 9), At(9, 9)};
  int64_t area = 0;
  for (const auto& triangle : Triangulate(points, 10, 10)) {
    area += DoubledArea(points, triangle);
  }
  EXPECT_EQ(area, 2 * 81);
}

TEST(Triangulation, NoPointLiesInsideTheCircleOfATriangle) {
  std::mt19937 random(7);
  std::vector<CrediblePoint> points;
  for (int i = 0; i < 60; ++i) {
    points.push_back(
        At(static_cast<int>(random() % 100), static_cast<int>(random() % 80)));
  }
  const auto triangles = Triangulate(points, 100, 80);
  ASSERT_GT(triangles.size(), 50u);
  for (const auto& t : triangles) {
    ASSERT_GT(DoubledArea(points, t), 0);
    const double ax = points[t[0]].col, ay = points[t[0]].row;
    const double bx = points[t[1]].col - ax, by = points[t[1]].row - ay;
    const double cx = points[t[2]].col - ax, cy = points[t[2]].row - ay;
    const double d = 2 * (bx * cy - by * cx);
    const double ux = (cy * (bx * bx + by * by) - by * (cx * cx + cy * cy)) / d;
    const double uy = (bx * (cx * cx + cy * cy) - cx * (bx * bx + by * by)) / d;
    for (const CrediblePoint& p : points) {
      const double dx = p.col - ax - ux, dy = p.row - ay - uy;
      EXPECT_GE(dx * dx + dy * dy, (ux * ux + uy * uy) * (1 - 1e-9));
    }
  }
}

}  // namespace
}  // namespace hpm
