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
  const InverseDepthMap map =
      InverseDepthMap::Of({0.0f, -1.0f, 1e-9f, 4.0f, 2.0f});
  EXPECT_EQ(Value(map, 0), 0);
  EXPECT_EQ(Value(map, 1), 0);
  EXPECT_EQ(Value(map, 2), map.step);
  EXPECT_NEAR(Value(map, 3), 4, 1e-6);
}

TEST(InverseDepthMap, OneWrongPixelNextToTheCameraCostsTheOthersNothing) {
  std::vector<float> values(1000, 0.5f);
  values[7] = 1e6f;
  const InverseDepthMap map = InverseDepthMap::Of(values);
  EXPECT_NEAR(Value(map, 0), 0.5f, 2e-6f);
  EXPECT_NEAR(Value(map, 7), 32, 1e-4f);
}

TEST(InverseDepthMap, WithoutAnyDepthItIsEmptyOfThem) {
  const InverseDepthMap map = InverseDepthMap::Of({0.0f, 0.0f});
  EXPECT_EQ(Value(map, 0), 0);
  EXPECT_EQ(Value(map, 1), 0);
}

}  // namespace
}  // namespace hpm
