#include "colmap_plugin/workspace/source_selection.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr double kDegree = 3.14159265358979323846 / 180;

// On the axis of two cameras at x = 0 and x = 1: seen under `degrees` by them.
Eigen::Vector3d PointUnderAngle(double degrees) {
  return {0.5, 0, 0.5 / std::tan(degrees / 2 * kDegree)};
}

std::vector<int> Select(const SourceSelector& selector,
                        int ref,
                        double min_angle,
                        int max_num) {
  return SelectWideEnough(selector.Candidates(ref, min_angle), max_num);
}

// The angle that decides about the pair, in degrees.
void ExpectAngle(const SourceSelector& selector,
                 int ref,
                 int image,
                 double angle) {
  EXPECT_THAT(Select(selector, ref, angle - 1e-4, 20), ElementsAre(image));
  EXPECT_THAT(Select(selector, ref, angle + 1e-4, 20), IsEmpty()) << angle;
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
  const TrackIndex tracks(workspace);
  const SourceSelector selector(workspace, tracks);
  EXPECT_THAT(Select(selector, 2, 1, -1), ElementsAre(1, 3, 0));
  EXPECT_THAT(Select(selector, 2, 1, 2), ElementsAre(1, 3));
  EXPECT_THAT(Select(selector, 2, 1, 0), IsEmpty());
  EXPECT_THAT(Select(selector, 4, 1, 20), ElementsAre(0));
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
    const TrackIndex tracks(workspace);
    const SourceSelector selector(workspace, tracks);
    const auto candidates = selector.Candidates(0, 1);
    ASSERT_EQ(candidates.size(), 1u);
    EXPECT_EQ(candidates[0].num_shared, static_cast<uint64_t>(n));
    ExpectAngle(selector, 0, 1, expected[n - 1]);
  }
}

TEST(SourceSelection, ObtuseAnglesCountFromTheirSupplement) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint(PointUnderAngle(150), {0, 1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  ExpectAngle(SourceSelector(workspace, tracks), 0, 1, 30);
}

TEST(SourceSelection, SmallAnglesAreDropped) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint(PointUnderAngle(1.5), {0, 1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const SourceSelector selector(workspace, tracks);
  EXPECT_THAT(Select(selector, 0, 1.4, 20), ElementsAre(1));
  EXPECT_THAT(Select(selector, 0, 1.6, 20), IsEmpty());
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
  const TrackIndex tracks(workspace);
  const SourceSelector selector(workspace, tracks);
  for (const int ref : {0, 1}) {
    const auto candidates = selector.Candidates(ref, 4);
    ASSERT_EQ(candidates.size(), 1u);
    EXPECT_EQ(candidates[0].num_shared, 7u);
    EXPECT_EQ(candidates[0].num_narrow, 6u);
    ExpectAngle(selector, ref, 1 - ref, 3);
  }
}

TEST(SourceSelection, SamePlaceAndPointAtTheCentreGiveAngleZero) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("twin.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {0, 0, 5});
  files.AddPoint({0, 0, 5}, {0, 1, 2});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const SourceSelector selector(workspace, tracks);
  EXPECT_THAT(Select(selector, 0, 1e-9, 20), IsEmpty());
  EXPECT_THAT(Select(selector, 0, 0, 20), ElementsAre(1, 2));
}

TEST(SourceSelection, UnusableImagesTakeNoPlace) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImagePose("broken.jpg", "1 0 0 0 nan 0 0");
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint({0, 0, 5}, {0, 1, 2});
  files.AddPoint({0, 1, 5}, {0, 1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const SourceSelector selector(workspace, tracks);
  EXPECT_THAT(Select(selector, 0, 1, 1), ElementsAre(2));
  EXPECT_THAT(Select(selector, 1, 1, 1), IsEmpty());
  const auto of_all = selector.CandidatesOf({0, 1, 2}, 1);
  EXPECT_THAT(SelectWideEnough(of_all[0], -1), ElementsAre(2));
  EXPECT_THAT(SelectWideEnough(of_all[1], -1), IsEmpty());
}

// `num` of the images, few in their places.
std::vector<int> Shuffled(int num_images, int num) {
  std::vector<int> images;
  for (int i = 0; i < num; ++i) images.push_back((7 * i + 3) % num_images);
  return images;
}

// What COLMAP computes, written down plainly: all angles, sorted.
std::vector<int> PlainlySelected(const Workspace& workspace,
                                 int ref,
                                 double min_angle) {
  std::map<int, std::vector<float>> angles;
  const SparsePoints& points = workspace.model().points;
  for (size_t i = 0; i < points.size(); ++i) {
    for (const int own : points[i].track) {
      if (own != ref) continue;
      for (const int image : points[i].track) {
        if (image == ref) continue;
        const Eigen::Vector3d a = workspace.Center(ref) - points[i].xyz;
        const Eigen::Vector3d b = workspace.Center(image) - points[i].xyz;
        const double cos =
            std::abs(a.dot(b)) / std::sqrt(a.squaredNorm() * b.squaredNorm());
        angles[image].push_back(
            static_cast<float>(std::acos(std::min(1.0, cos))));
      }
    }
  }
  std::vector<int> images;
  for (auto& [image, all] : angles) {
    std::sort(all.begin(), all.end());
    const auto rank = static_cast<size_t>(
        std::round(0.75 * static_cast<double>(all.size() - 1)));
    if (all[rank] >= static_cast<float>(min_angle * kDegree))
      images.push_back(image);
  }
  std::stable_sort(images.begin(), images.end(), [&](int a, int b) {
    return angles[a].size() > angles[b].size();
  });
  return images;
}

TEST(SourceSelection, IsThatOfAllAnglesSortedForAnyBoundAndAnyThread) {
  TestWorkspace files;
  constexpr int kNumImages = 30;
  uint32_t state = 1;
  const auto random = [&](uint32_t bound) {
    state = 1664525 * state + 1013904223;
    return (state >> 8) % bound;
  };
  for (int i = 0; i < kNumImages; ++i)
    files.AddImage(fmt::format("{}.jpg", i), {0.3 * (i % 6), 0.3 * (i / 6), 0});
  for (int i = 0; i < 400; ++i) {
    std::vector<int> track;
    for (uint32_t k = 0; k < 2 + random(9); ++k)
      track.push_back(static_cast<int>(random(kNumImages)));
    files.AddPoint({0.1 * random(20), 0.1 * random(20), 2.0 + random(30)},
                   track);
  }
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  const SourceSelector selector(workspace, tracks);
  for (const double min_angle : {0.0, 0.5, 1.0, 2.0, 5.0, 30.0, 89.9, 91.0}) {
    tbb::parallel_for(0, kNumImages, [&](int ref) {
      EXPECT_EQ(Select(selector, ref, min_angle, -1),
                PlainlySelected(workspace, ref, min_angle))
          << ref << " " << min_angle;
    });
    // A few images, which are counted one by one, and most, pair by pair.
    for (const std::vector<int>& refs :
         {std::vector<int>{7, 3}, Shuffled(kNumImages, 20)}) {
      std::atomic<size_t> num_heard{0};
      const auto candidates =
          selector.CandidatesOf(refs, min_angle, {}, [&] { ++num_heard; });
      EXPECT_EQ(num_heard, refs.size());
      ASSERT_EQ(candidates.size(), refs.size());
      for (size_t i = 0; i < refs.size(); ++i) {
        EXPECT_EQ(SelectWideEnough(candidates[i], -1),
                  PlainlySelected(workspace, refs[i], min_angle))
            << refs[i] << " " << min_angle;
      }
    }
  }
}

TEST(SourceSelection, HearsCancelWithinAnImageOfManyPoints) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("b.jpg", {1, 0, 0});
  files.AddPoint({0, 0, 5}, std::vector<int>{0, 1});
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  CancelToken cancel;
  cancel.Cancel();
  EXPECT_THROW(SourceSelector(workspace, tracks).Candidates(0, 1, cancel),
               Error);
  EXPECT_THROW(TrackIndex(workspace, cancel), Error);
}

TEST(TrackIndex, GivesEachPointOfAnImageWithItsRepeats) {
  TestWorkspace files;
  for (int i = 0; i < 3; ++i)
    files.AddImage(fmt::format("{}.jpg", i), {1.0 * i, 0, 0});
  // Steps of one, two and three bytes.
  std::map<size_t, size_t> expected = {{0, 2}, {1, 1}, {128, 1}, {20000, 3}};
  for (size_t i = 0; i <= 20000; ++i) {
    std::vector<int> track = {1};
    if (expected.count(i)) track.insert(track.end(), expected[i], 0);
    track.push_back(1);
    files.AddPoint({0, 0, 5}, track);
  }
  const Workspace workspace = files.Open();
  const TrackIndex tracks(workspace);
  constexpr auto kPoints = TrackIndex::Reads::kPoints;
  std::map<size_t, size_t> found;
  tracks.ForEachPoint(0, kPoints, [&](size_t point, size_t count) {
    found[point] = count;
    return true;
  });
  EXPECT_EQ(found, expected);
  size_t num_points = 0;
  tracks.ForEachPoint(1, kPoints, [&](size_t point, size_t count) {
    EXPECT_EQ(point, num_points);
    EXPECT_EQ(count, 2u);
    return ++num_points < 300;
  });
  EXPECT_EQ(num_points, 300u);
  tracks.ForEachPoint(2, kPoints, [](size_t, size_t) {
    ADD_FAILURE();
    return true;
  });
}

}  // namespace
}  // namespace hpm
