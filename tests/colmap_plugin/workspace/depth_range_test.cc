#include "colmap_plugin/workspace/depth_range.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <limits>

namespace hpm {
namespace {

TEST(DepthRange, IsCutFromTheFirstAndTheLastPercentile) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {0, 0, -10});
  // Elements floor(150 * 0.01) = 1 and floor(150 * 0.99) = 148 of depths 1 ...
  // 150.
  for (int i = 0; i < 150; ++i)
    files.AddPoint({0, 0, 1.0 + (i * 77) % 150}, {0, 1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const DepthRanges ranges(workspace, tracks, -1, -1);
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->min, 0.75f * 2);
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->max, 1.25f * 149);
  EXPECT_FLOAT_EQ(ranges.ForImage(1)->min, 0.75f * 12);
  EXPECT_FLOAT_EQ(ranges.ForImage(1)->max, 1.25f * 159);
}

TEST(DepthRange, PointsBehindTheCameraDoNotCount) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  files.AddPoint({0, 0, -100}, {0});
  files.AddPoint({0, 0, 0}, {0});
  const Workspace workspace = files.Open();
  const DepthRange range =
      DepthRanges(workspace, TrackIndex(workspace), -1, -1).ForImage(0).value();
  EXPECT_FLOAT_EQ(range.min, 3);
  EXPECT_FLOAT_EQ(range.max, 5);
}

TEST(DepthRange, OneNegativeEndMakesBothAutomatic) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  const Workspace workspace = files.Open();
  EXPECT_FLOAT_EQ(
      DepthRanges(workspace, TrackIndex(workspace), 1, -1).ForImage(0)->min, 3);
  EXPECT_FLOAT_EQ(
      DepthRanges(workspace, TrackIndex(workspace), -1, 100).ForImage(0)->max,
      5);
}

TEST(DepthRange, GivenRangeHoldsForAllImagesEvenWithoutPoints) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  const Workspace workspace = files.Open();
  const DepthRange range =
      DepthRanges(workspace, TrackIndex(workspace), 2, 8).ForImage(0).value();
  EXPECT_EQ(range.min, 2);
  EXPECT_EQ(range.max, 8);
}

// What lies outside must be found to be dropped.
TEST(DepthRange, AGivenRangeIsSearchedBeyondAsFarAsThePointsGo) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  for (size_t i = 0; i < kEnoughPoints; ++i)
    files.AddPoint({0, 0, i % 2 == 0 ? 4.0 : 8.0}, {0});
  const Workspace workspace = files.Open();
  const DepthRanges inner(workspace, TrackIndex(workspace), 4, 5);
  EXPECT_FLOAT_EQ(inner.ForImage(0)->min, 3);
  EXPECT_FLOAT_EQ(inner.ForImage(0)->max, 10);
  EXPECT_FLOAT_EQ(inner.Published(0).min, 4);
  EXPECT_FLOAT_EQ(inner.Published(0).max, 5);
  const DepthRange apart =
      *DepthRanges(workspace, TrackIndex(workspace), 1, 2).ForImage(0);
  EXPECT_FLOAT_EQ(apart.min, 1);
  EXPECT_FLOAT_EQ(apart.max, 8);  // far points may be wrong: 4 times
  const DepthRange beyond =
      *DepthRanges(workspace, TrackIndex(workspace), 20, 30).ForImage(0);
  EXPECT_FLOAT_EQ(beyond.min, 5);
  EXPECT_FLOAT_EQ(beyond.max, 30);
}

TEST(DepthRange, WithAnAutomaticRangeEverythingIsPublished) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  const Workspace workspace = files.Open();
  const DepthRange published =
      DepthRanges(workspace, TrackIndex(workspace), -1, -1).Published(0);
  EXPECT_EQ(published.min, 0);
  EXPECT_GT(published.max, 1e30);
}

TEST(DepthRange, DegenerateGivenRangesAreWidened) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  const Workspace workspace = files.Open();
  const DepthRange equal =
      DepthRanges(workspace, TrackIndex(workspace), 4, 4).ForImage(0).value();
  EXPECT_FLOAT_EQ(equal.min, 3);
  EXPECT_FLOAT_EQ(equal.max, 5);
  const DepthRange from_zero =
      DepthRanges(workspace, TrackIndex(workspace), 0, 4).ForImage(0).value();
  EXPECT_FLOAT_EQ(from_zero.min, 0.004f);
  EXPECT_EQ(from_zero.max, 4);
}

TEST(DepthRange, ImpossibleGivenRangesAreUsageErrors) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  const Workspace workspace = files.Open();
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::pair<double, double> bad[] = {
      {5, 4},
      {0, 0},
      {nan, 4},
      {4, nan},
      {1, std::numeric_limits<double>::infinity()}};
  for (const auto& [min, max] : bad) {
    const auto error = ErrorOf([&, a = min, b = max] {
      DepthRanges(workspace, TrackIndex(workspace), a, b);
    });
    ASSERT_TRUE(error) << min << " " << max;
    EXPECT_EQ(error->code(), ErrorCode::kUsage);
  }
}

TEST(DepthRange, WithoutPointsAndOtherViewsItIsUnknown) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("same_place.jpg", {0, 0, 0});
  files.AddImagePose("broken.jpg", "1 0 0 0 nan 0 0");
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const DepthRanges ranges(workspace, tracks, -1, -1);
  for (const int image : {0, 1, 2}) EXPECT_FALSE(ranges.ForImage(image));
}

TEST(DepthRange, EnoughTrackedPointsAreNeverEstimated) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  for (int i = 0; i < 10; ++i) files.AddPoint({0, 0, 4}, {0});
  for (int i = 0; i < 90; ++i) files.AddPoint({0.5, 0, 8}, {1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const DepthRanges ranges(workspace, tracks, -1, -1);
  EXPECT_FALSE(ranges.IsEstimated(0));
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->max, 5);
}

TEST(DepthRange, PointsWithoutTracksCountWhereTheyProject) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  for (int i = 0; i < 10; ++i) {
    files.AddPoint({0.1 * i, 0, 4}, {});
    files.AddPoint({0, 0.1 * i, 6}, {});
    files.AddPoint({0, 0, -20}, {});   // behind the camera
    files.AddPoint({100, 0, 20}, {});  // beside the image
  }
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const DepthRanges ranges(workspace, tracks, -1, -1);
  EXPECT_TRUE(ranges.IsEstimated(0));
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->min, 3);
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->max, 7.5f);
}

TEST(DepthRange, WhatLiesFarBehindASurfaceIsHidden) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  // A wall that fills the image, and another house behind it; one point floats
  // before the wall.
  for (int x = -40; x <= 40; ++x) {
    for (int y = -30; y <= 30; ++y) {
      files.AddPoint({0.08 * x, 0.08 * y, 4}, {});
      if (x % 4 == 0 && y % 4 == 0) files.AddPoint({1. * x, 1. * y, 50}, {});
    }
  }
  files.AddPoint({0, 0, 0.5}, {});
  const Workspace workspace = files.Open();
  const DepthRange range =
      DepthRanges(workspace, TrackIndex(workspace), -1, -1).ForImage(0).value();
  EXPECT_FLOAT_EQ(range.min, 3);
  EXPECT_FLOAT_EQ(range.max, 5);
}

TEST(DepthRange, AFewTrackedPointsAreWidenedByThoseThatProject) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint({0, 0, 4}, {0, 1});
  for (int i = 0; i < 20; ++i) files.AddPoint({0.1 * i, 0.5, 8}, {1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const DepthRanges ranges(workspace, tracks, -1, -1);
  EXPECT_TRUE(ranges.IsEstimated(0));
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->min, 3);
  EXPECT_FLOAT_EQ(ranges.ForImage(0)->max, 10);
  EXPECT_FALSE(ranges.IsEstimated(1));
}

TEST(DepthRange, WhereNoPointProjectsTheRangesOfTheOthersTell) {
  for (const std::vector<int>& track : {std::vector<int>{1}, {}}) {
    TestWorkspace files;
    files.AddImage("a.jpg", {0, 0, 0});
    files.AddImage("b.jpg", {3, 0, 0});
    // At the right border of b, where a does not look.
    for (int i = 0; i < 20; ++i) files.AddPoint({8.9, 0.1 * i, 8}, track);
    const Workspace workspace = files.Open();
    const DepthRange range =
        DepthRanges(workspace, TrackIndex(workspace), -1, -1)
            .ForImage(0)
            .value();
    EXPECT_LT(range.min, 7);
    EXPECT_GT(range.min, 3);
    EXPECT_GT(range.max, 9);
    EXPECT_LT(range.max, 16);
  }
}

TEST(DepthRange, AFewPointsWithoutTracksAreWidenedByThePoses) {
  TestWorkspace files;
  for (int i = 0; i < 3; ++i)
    files.AddImage(fmt::format("{}.jpg", i), {1.0 * i, 0, 0});
  for (int i = 0; i < 3; ++i) files.AddPoint({0.1 * i, 0, 100}, {});
  const Workspace workspace = files.Open();
  const DepthRange range =
      DepthRanges(workspace, TrackIndex(workspace), -1, -1).ForImage(0).value();
  EXPECT_LT(range.min, 4);
  EXPECT_FLOAT_EQ(range.max, 125);
}

TEST(DepthRange, WithoutAnyPointsThePosesTell) {
  TestWorkspace files;
  // A walk of one unit a step past something about 8 units away.
  for (int i = 0; i < 6; ++i)
    files.AddImage(fmt::format("{}.jpg", i), {1.0 * i, 0, 0});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const DepthRanges ranges(workspace, tracks, -1, -1);
  for (int image = 0; image < 6; ++image) {
    const DepthRange range = ranges.ForImage(image).value();
    EXPECT_LT(range.min, 4) << image;
    EXPECT_GT(range.min, 0.1) << image;
    EXPECT_GT(range.max, 16) << image;
    EXPECT_LT(range.max, 300) << image;
  }
}

// As geo-registered models are: there float32 steps by half a unit.
TEST(DepthRange, EstimatesDoNotSufferFarFromTheOrigin) {
  for (const Eigen::Vector3d& origin :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(5e6, -4e6, 0)}) {
    TestWorkspace files;
    files.AddImage("a.jpg", origin);
    for (int i = 0; i < 20; ++i)
      files.AddPoint(origin + Eigen::Vector3d(0.01 * i, 0, 1), {});
    const Workspace workspace = files.Open();
    const DepthRange range =
        DepthRanges(workspace, TrackIndex(workspace), -1, -1)
            .ForImage(0)
            .value();
    EXPECT_NEAR(range.min, 0.75, 1e-6);
    EXPECT_NEAR(range.max, 1.25, 1e-6);
  }
}

}  // namespace
}  // namespace hpm
