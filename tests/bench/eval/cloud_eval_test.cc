#include "bench/eval/cloud_eval.h"

#include "bench/eval/statistics.h"
#include "src/base/error.h"

#include <cmath>
#include <limits>

#include <gtest/gtest.h>

namespace hpm {
namespace {

std::vector<Vec3f> Grid(int size, float spacing, float z) {
  std::vector<Vec3f> points;
  for (int i = 0; i < size; ++i) {
    for (int j = 0; j < size; ++j) {
      points.push_back({spacing * static_cast<float>(i),
                        spacing * static_cast<float>(j),
                        z});
    }
  }
  return points;
}

TEST(CloudEval, AShiftOfTheWholeCloudIsItsDistanceBothWays) {
  const CloudEvaluation result =
      EvaluateCloud(Grid(20, 1.0f, 0.25f), Grid(20, 1.0f, 0), {0.2, 0.3});
  EXPECT_NEAR(result.accuracy_median, 0.25, 1e-6);
  EXPECT_NEAR(result.completeness_mean, 0.25, 1e-6);
  EXPECT_EQ(result.scores[0].f1, 0);
  EXPECT_EQ(result.scores[1].f1, 1);
  EXPECT_EQ(result.scores[1].balanced_f1, 1);
}

TEST(CloudEval, HalfACloudIsAccurateAndHalfComplete) {
  std::vector<Vec3f> half = Grid(20, 1.0f, 0);
  half.resize(200);
  const CloudEvaluation result = EvaluateCloud(half, Grid(20, 1.0f, 0), {0.1});
  EXPECT_EQ(result.scores[0].accuracy, 1);
  EXPECT_EQ(result.scores[0].completeness, 0.5);
  EXPECT_NEAR(result.scores[0].f1, 2.0 / 3, 1e-12);
}

TEST(CloudEval, BalancingTakesAwayTheWeightOfADenseSpot) {
  // 999 right points in one voxel, one wrong point in another.
  std::vector<Vec3f> estimate;
  for (int i = 0; i < 999; ++i)
    estimate.push_back({0.01f, 0.01f, 0.0001f * static_cast<float>(i)});
  estimate.push_back({50, 50, 50});
  const CloudEvaluation result =
      EvaluateCloud(estimate, {{0.01f, 0.01f, 0.05f}}, {0.5});
  EXPECT_NEAR(result.scores[0].accuracy, 0.999, 1e-9);
  EXPECT_NEAR(result.scores[0].balanced_accuracy, 0.5, 1e-9);
}

TEST(CloudEval, PointsThatAreNotFiniteAreLeftOut) {
  std::vector<Vec3f> estimate = Grid(5, 1.0f, 0);
  estimate.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  estimate.push_back({0, std::numeric_limits<float>::infinity(), 0});
  const CloudEvaluation result =
      EvaluateCloud(estimate, Grid(5, 1.0f, 0), {0.1});
  EXPECT_EQ(result.num_points, 25u);
  EXPECT_EQ(result.scores[0].f1, 1);
}

TEST(CloudEval, AnEmptyEstimateScoresNothing) {
  const CloudEvaluation result = EvaluateCloud({}, Grid(5, 1.0f, 0), {0.1});
  EXPECT_EQ(result.num_points, 0u);
  EXPECT_EQ(result.scores[0].f1, 0);
  EXPECT_TRUE(std::isnan(result.accuracy_median));
}

TEST(CloudEval, AnEmptyTruthIsAnError) {
  EXPECT_THROW(EvaluateCloud(Grid(5, 1.0f, 0), {}, {0.1}), Error);
}

TEST(Statistics, MedianIsTheMiddleOrTheMeanOfTheTwoMiddleValues) {
  EXPECT_EQ(Median({3, 1, 2}), 2);
  EXPECT_EQ(Median({4, 1, 2, 3}), 2.5);
  EXPECT_TRUE(std::isnan(Median({})));
}

}  // namespace
}  // namespace hpm
