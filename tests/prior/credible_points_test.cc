#include "src/prior/credible_points.h"

#include "tests/prior/prior_scene.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(CrediblePoints, OnePerCellAndOnThePlane) {
  const Camera camera = PriorCamera(23, 12);
  const HypothesisMap map = PlaneMap(camera, TiltedPlane(), 0.05f);
  const auto points = FindCrediblePoints(MakeLevel(map, camera, 0), 0.1f);
  EXPECT_EQ(points.size(), 5u * 3u);
  for (const CrediblePoint& point : points) {
    EXPECT_NEAR(Dot(TiltedPlane().normal, point.position),
                -TiltedPlane().distance,
                1e-4f);
  }
}

TEST(CrediblePoints, TheCheapestOfTheCellIsTaken) {
  const Camera camera = PriorCamera(5, 5);
  HypothesisMap map = PlaneMap(camera, TiltedPlane(), 0.09f);
  map.costs[3 * 5 + 4] = 0.02f;
  const auto points = FindCrediblePoints(MakeLevel(map, camera, 0), 0.1f);
  ASSERT_EQ(points.size(), 1u);
  EXPECT_EQ(points[0].col, 4);
  EXPECT_EQ(points[0].row, 3);
}

TEST(CrediblePoints, CostsAtTheThresholdAreNotCredible) {
  const Camera camera = PriorCamera(10, 10);
  const HypothesisMap map = PlaneMap(camera, TiltedPlane(), 0.1f);
  EXPECT_TRUE(FindCrediblePoints(MakeLevel(map, camera, 0), 0.1f).empty());
}

}  // namespace
}  // namespace hpm
