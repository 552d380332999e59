#include "bench/eval/splat.h"

#include <limits>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// Looks along z; the principal point of the model is the middle of the picture.
Camera Frontal() {
  return {20,
          10,
          10.0f,
          10.0f,
          10.0f,
          5.0f,
          {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
          {0, 0, 0}};
}

TEST(Splat, ANearerPointHidesOneBehindIt) {
  PointCloud cloud;
  cloud.points = {{0, 0, 1}, {0, 0, 2}};
  cloud.colors = {{255, 0, 0}, {0, 255, 0}};
  const cv::Mat picture = SplatCloud(cloud, Frontal(), 2);
  EXPECT_EQ(picture.at<cv::Vec3b>(5, 10), cv::Vec3b(0, 0, 255));  // BGR
  EXPECT_EQ(picture.at<cv::Vec3b>(0, 0), cv::Vec3b(255, 255, 255));
}

TEST(Splat, PointsBehindBesideOrNowhereDrawNothing) {
  PointCloud cloud;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  cloud.points = {
      {0, 0, -1}, {1e30f, 0, 1}, {nan, 0, 1}, {0, 0, nan}, {0, 0, 0}};
  const cv::Mat picture = SplatCloud(cloud, Frontal(), 3);
  EXPECT_EQ(cv::countNonZero(picture.reshape(1) != 255), 0);
}

}  // namespace
}  // namespace hpm
