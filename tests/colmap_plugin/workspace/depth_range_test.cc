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
  const DepthRanges ranges(workspace, -1, -1);
  EXPECT_FLOAT_EQ(ranges.ForImage(0).min, 0.75f * 2);
  EXPECT_FLOAT_EQ(ranges.ForImage(0).max, 1.25f * 149);
  EXPECT_FLOAT_EQ(ranges.ForImage(1).min, 0.75f * 12);
  EXPECT_FLOAT_EQ(ranges.ForImage(1).max, 1.25f * 159);
}

TEST(DepthRange, PointsBehindTheCameraDoNotCount) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  files.AddPoint({0, 0, -100}, {0});
  files.AddPoint({0, 0, 0}, {0});
  const Workspace workspace = files.Open();
  const DepthRange range = DepthRanges(workspace, -1, -1).ForImage(0);
  EXPECT_FLOAT_EQ(range.min, 3);
  EXPECT_FLOAT_EQ(range.max, 5);
}

TEST(DepthRange, OneNegativeEndMakesBothAutomatic) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  const Workspace workspace = files.Open();
  EXPECT_FLOAT_EQ(DepthRanges(workspace, 1, -1).ForImage(0).min, 3);
  EXPECT_FLOAT_EQ(DepthRanges(workspace, -1, 100).ForImage(0).max, 5);
}

TEST(DepthRange, GivenRangeHoldsForAllImagesEvenWithoutPoints) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  const Workspace workspace = files.Open();
  const DepthRange range = DepthRanges(workspace, 2, 8).ForImage(0);
  EXPECT_EQ(range.min, 2);
  EXPECT_EQ(range.max, 8);
}

// What lies outside must be found to be dropped.
TEST(DepthRange, AGivenRangeIsSearchedBeyondAsFarAsThePointsGo) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  files.AddPoint({0, 0, 8}, {0});
  const Workspace workspace = files.Open();
  const DepthRanges inner(workspace, 4, 5);
  EXPECT_FLOAT_EQ(inner.ForImage(0).min, 3);
  EXPECT_FLOAT_EQ(inner.ForImage(0).max, 10);
  EXPECT_FLOAT_EQ(inner.Published().min, 4);
  EXPECT_FLOAT_EQ(inner.Published().max, 5);
  const DepthRange apart = DepthRanges(workspace, 1, 2).ForImage(0);
  EXPECT_FLOAT_EQ(apart.min, 1);
  EXPECT_FLOAT_EQ(apart.max, 8);  // far points may be wrong: 4 times
  const DepthRange beyond = DepthRanges(workspace, 20, 30).ForImage(0);
  EXPECT_FLOAT_EQ(beyond.min, 5);
  EXPECT_FLOAT_EQ(beyond.max, 30);
}

TEST(DepthRange, WithAnAutomaticRangeEverythingIsPublished) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0});
  const Workspace workspace = files.Open();
  const DepthRange published = DepthRanges(workspace, -1, -1).Published();
  EXPECT_EQ(published.min, 0);
  EXPECT_GT(published.max, 1e30);
}

TEST(DepthRange, DegenerateGivenRangesAreWidened) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  const Workspace workspace = files.Open();
  const DepthRange equal = DepthRanges(workspace, 4, 4).ForImage(0);
  EXPECT_FLOAT_EQ(equal.min, 3);
  EXPECT_FLOAT_EQ(equal.max, 5);
  const DepthRange from_zero = DepthRanges(workspace, 0, 4).ForImage(0);
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
    const auto error =
        ErrorOf([&, a = min, b = max] { DepthRanges(workspace, a, b); });
    ASSERT_TRUE(error) << min << " " << max;
    EXPECT_EQ(error->code(), ErrorCode::kUsage);
  }
}

TEST(DepthRange, UnknownRangeNamesTheImageAndTheOptions) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("behind.jpg", {0, 0, 10});
  files.AddImage("alone.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 4}, {0, 1});
  const Workspace workspace = files.Open();
  const DepthRanges ranges(workspace, -1, -1);
  EXPECT_GT(ranges.ForImage(0).min, 0);
  for (const int image : {1, 2}) {
    const auto error = ErrorOf([&] { ranges.ForImage(image); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), testing::HasSubstr(workspace.ImageName(image)));
    EXPECT_THAT(error->what(), testing::HasSubstr("depth_min"));
    EXPECT_THAT(error->what(), testing::HasSubstr("depth_max"));
  }
}

}  // namespace
}  // namespace hpm
