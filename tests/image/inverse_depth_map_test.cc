#include "src/image/inverse_depth_map.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

float Value(const InverseDepthMap& map, size_t i) {
  return map.step * InverseDepthSteps(map.steps.data(), i);
}

TEST(InverseDepthMap, KeepsValuesToAStepOfTheLargest) {
  const std::vector<float> values = {0.5f, 0.013f, 0.25f, 0.4999f};
  const InverseDepthMap map = InverseDepthMap::Of(values);
  for (size_t i = 0; i < values.size(); ++i) {
    EXPECT_NEAR(Value(map, i), values[i], 1e-7f);
  }
}

TEST(InverseDepthMap, NoDepthStaysNoneAndTheFarthestStaysADepth) {
  const InverseDepthMap map = InverseDepthMap::Of({0.0f, -1.0f, 1e-9f, 4.0f});
  EXPECT_EQ(Value(map, 0), 0);
  EXPECT_EQ(Value(map, 1), 0);
  EXPECT_EQ(Value(map, 2), map.step);
  EXPECT_NEAR(Value(map, 3), 4, 1e-6);
}

TEST(InverseDepthMap, WithoutAnyDepthItIsEmptyOfThem) {
  const InverseDepthMap map = InverseDepthMap::Of({0.0f, 0.0f});
  EXPECT_EQ(Value(map, 0), 0);
  EXPECT_EQ(Value(map, 1), 0);
}

TEST(InverseDepthMap, OfHypothesesIsThatAtPixelCentres) {
  Camera camera = {};
  camera.width = 3;
  camera.height = 2;
  camera.fx = camera.fy = 5;
  camera.cx = 1;
  camera.cy = 0.5f;
  HypothesisMap hypotheses(3, 2);
  for (int i = 0; i < 6; ++i) {
    hypotheses.planes[i] = {{0.1f, 0.2f, -0.9f}, 2.0f + static_cast<float>(i)};
  }
  hypotheses.planes[4].distance = 0;
  const InverseDepthMap map = InverseDepthMap::Of(hypotheses, camera);
  for (int i = 0; i < 6; ++i) {
    if (i == 4) continue;
    const float z = DepthAt(camera,
                            hypotheses.planes[i],
                            static_cast<float>(i % 3),
                            static_cast<float>(i / 3));
    EXPECT_NEAR(Value(map, i) * z, 1, 1e-6);
  }
  EXPECT_EQ(Value(map, 4), 0);
}

}  // namespace
}  // namespace hpm
