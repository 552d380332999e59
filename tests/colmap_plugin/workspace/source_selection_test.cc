#include "colmap_plugin/workspace/source_selection.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <cmath>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kDegree = 3.14159265358979323846 / 180;

// On the axis of two cameras at x = 0 and x = 1: seen under `degrees` by them.
Eigen::Vector3d PointUnderAngle(double degrees) {
  return {0.5, 0, 0.5 / std::tan(degrees / 2 * kDegree)};
}

TEST(SourceSelection, SortsBySharedPointsThenByImageIndex) {
  TestWorkspace files;
  for (int i = 0; i < 5; ++i)
    files.AddImage(fmt::format("{}.jpg", i), {1.0 * i, 0, 0});
  // Shared with image 2: one with 0, two with 1, none with 4, two with 3.
  files.AddPoint({0, 0, 5}, {0, 1, 2, 3});
  files.AddPoint({1, 0, 5}, {1, 2, 3});
  files.AddPoint({2, 0, 5}, {0, 4});
  const Workspace workspace = files.Open();
  const SourceSelector selector(workspace);
  EXPECT_THAT(selector.Select(2, 1, -1), ElementsAre(1, 3, 0));
  EXPECT_THAT(selector.Select(2, 1, 2), ElementsAre(1, 3));
  EXPECT_THAT(selector.Select(2, 1, 0), IsEmpty());
  EXPECT_THAT(selector.Select(4, 1, 20), ElementsAre(0));
}

TEST(SourceSelection, AngleIsTheNearestRankOfThreeQuarters) {
  // Rank round(0.75 (n - 1)): 2 of 3, 2 of 4, 3 of 5, 4 of 6 (3.75 -> 4).
  const double angles[] = {12, 2, 8, 4, 10, 6};
  const double expected[] = {12, 12, 12, 8, 10, 10};
  for (int n = 1; n <= 6; ++n) {
    TestWorkspace files;
    files.AddImage("a.jpg", {0, 0, 0});
    files.AddImage("b.jpg", {1, 0, 0});
    for (int i = 0; i < n; ++i)
      files.AddPoint(PointUnderAngle(angles[i]), {0, 1});
    const Workspace workspace = files.Open();
    const auto candidates = SourceSelector(workspace).Candidates(0);
    ASSERT_EQ(candidates.size(), 1u);
    EXPECT_EQ(candidates[0].num_shared, static_cast<uint64_t>(n));
    EXPECT_NEAR(candidates[0].angle / kDegree, expected[n - 1], 1e-4) << n;
  }
}

TEST(SourceSelection, ObtuseAnglesCountFromTheirSupplement) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint(PointUnderAngle(150), {0, 1});
  const Workspace workspace = files.Open();
  EXPECT_NEAR(
      SourceSelector(workspace).Candidates(0).at(0).angle / kDegree, 30, 1e-4);
}

TEST(SourceSelection, SmallAnglesAreDropped) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint(PointUnderAngle(1.5), {0, 1});
  const Workspace workspace = files.Open();
  const SourceSelector selector(workspace);
  EXPECT_THAT(selector.Select(0, 1.4, 20), ElementsAre(1));
  EXPECT_THAT(selector.Select(0, 1.6, 20), IsEmpty());
}

TEST(SourceSelection, RepeatedTrackElementsCountAsPairs) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  // Six pairs under 3 degrees, one under 9: element round(0.75 * 6) = 5 of 7
  // is 3.
  files.AddPoint(PointUnderAngle(3), {0, 1, 1, 0, 1});
  files.AddPoint(PointUnderAngle(9), {0, 1});
  const Workspace workspace = files.Open();
  const SourceSelector selector(workspace);
  for (const int ref : {0, 1}) {
    const auto candidates = selector.Candidates(ref);
    ASSERT_EQ(candidates.size(), 1u);
    EXPECT_EQ(candidates[0].num_shared, 7u);
    EXPECT_NEAR(candidates[0].angle / kDegree, 3, 1e-4);
  }
}

TEST(SourceSelection, SamePlaceAndPointAtTheCentreGiveAngleZero) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("twin.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {0, 0, 5});
  files.AddPoint({0, 0, 5}, {0, 1, 2});
  const Workspace workspace = files.Open();
  const auto candidates = SourceSelector(workspace).Candidates(0);
  ASSERT_EQ(candidates.size(), 2u);
  EXPECT_EQ(candidates[0].angle, 0);
  EXPECT_EQ(candidates[1].angle, 0);
  EXPECT_THAT(SourceSelector(workspace).Select(0, 1, 20), IsEmpty());
  EXPECT_THAT(SourceSelector(workspace).Select(0, 0, 20), ElementsAre(1, 2));
}

TEST(SourceSelection, UnusableImagesTakeNoPlace) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImagePose("broken.jpg", "1 0 0 0 nan 0 0");
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint({0, 0, 5}, {0, 1, 2});
  files.AddPoint({0, 1, 5}, {0, 1});
  const Workspace workspace = files.Open();
  const SourceSelector selector(workspace);
  EXPECT_THAT(selector.Select(0, 1, 1), ElementsAre(2));
  EXPECT_THAT(selector.Select(1, 1, 1), IsEmpty());
}

}  // namespace
}  // namespace hpm
