// A model is the same wherever it lies.
#include "colmap_plugin/workspace/far_origin.h"

#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/source_selection.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Of the size of UTM and of earth-centred coordinates; exact in a float, as a
// metre beside them is not.
const Eigen::Vector3d kNear = {0, 0, 0};
const Eigen::Vector3d kUtm = {534000, 3378496, 128};
const Eigen::Vector3d kEarth = {2511680, 1438624, 5664736};

// Three cameras half a metre apart, points two to four metres before them.
void Write(const Eigen::Vector3d& at, TestWorkspace* files) {
  for (int i = 0; i < 3; ++i) {
    files->AddImage(fmt::format("{}.jpg", i),
                    at + Eigen::Vector3d(0.375 * i, 0.125 * i, 0));
  }
  for (int i = 0; i < 9; ++i) {
    files->AddPoint(at + Eigen::Vector3d(0.25 * i, 0.125, 2 + 0.25 * i),
                    {0, 1, i < 5 ? 2 : 1});
  }
}

StereoProblem ProblemOf(int ref) {
  StereoProblem problem;
  problem.ref_image = ref;
  problem.depth_min = 2;
  problem.depth_max = 4;
  return problem;
}

TEST(FarOrigin, RelativePosesDepthsAndAnglesAreThoseOfTheModelNearIt) {
  TestWorkspace near_files;
  Write(kNear, &near_files);
  const Workspace near = near_files.Open();
  const TrackIndex near_tracks(near);
  for (const Eigen::Vector3d& at : {kUtm, kEarth}) {
    TestWorkspace files;
    Write(at, &files);
    const Workspace workspace = files.Open();
    const TrackIndex tracks(workspace);
    for (int i = 0; i < 3; ++i) {
      for (int origin = 0; origin < 3; ++origin) {
        const Vec3f t = workspace.CameraAround(i, origin).t;
        const Vec3f expected = near.CameraAround(i, origin).t;
        EXPECT_NEAR(t.x, expected.x, 1e-6);
        EXPECT_NEAR(t.y, expected.y, 1e-6);
        EXPECT_NEAR(t.z, expected.z, 1e-6);
      }
      const DepthRange range =
          *DepthRanges(workspace, tracks, -1, -1).ForImage(i);
      const DepthRange expected =
          *DepthRanges(near, near_tracks, -1, -1).ForImage(i);
      EXPECT_NEAR(range.min, expected.min, 1e-6);
      EXPECT_NEAR(range.max, expected.max, 1e-6);
      for (const double min_angle : {0.5, 1.0, 2.0, 4.0, 8.0, 16.0}) {
        const auto candidates =
            SourceSelector(workspace, tracks).Candidates(i, min_angle);
        const auto near_candidates =
            SourceSelector(near, near_tracks).Candidates(i, min_angle);
        ASSERT_EQ(candidates.size(), near_candidates.size());
        for (size_t k = 0; k < candidates.size(); ++k) {
          EXPECT_EQ(candidates[k].image, near_candidates[k].image);
          EXPECT_EQ(candidates[k].num_narrow, near_candidates[k].num_narrow);
        }
      }
    }
  }
}

TEST(FarOrigin, IsWarnedOfOnceWithTheRemedy) {
  for (const Eigen::Vector3d& at : {kUtm, kEarth}) {
    TestWorkspace files;
    Write(at, &files);
    WarnOfFarOrigin(
        files.Open(), {ProblemOf(0), ProblemOf(2), ProblemOf(1)}, files.Log());
    EXPECT_THAT(files.Warnings(), ElementsAre(HasSubstr("model_aligner")));
  }
}

// Coordinates of a few kilometres lose nothing that matters.
TEST(FarOrigin, NearOriginsAreNoMatter) {
  for (const Eigen::Vector3d& at : {kNear, Eigen::Vector3d(1500, 800, 30)}) {
    TestWorkspace files;
    Write(at, &files);
    WarnOfFarOrigin(files.Open(), {ProblemOf(0), ProblemOf(1)}, files.Log());
    WarnOfFarOrigin(files.Open(), {}, files.Log());
    EXPECT_THAT(files.Warnings(), IsEmpty());
  }
}

}  // namespace
}  // namespace hpm
