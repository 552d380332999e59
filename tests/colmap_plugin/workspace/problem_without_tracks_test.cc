// Sources and ranges where the images of the sparse model share no tracks.
#include "colmap_plugin/workspace/problem.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Models of feed-forward networks, and of converters that know poses only.
class WithoutTracksTest : public ::testing::Test {
 protected:
  // Cameras on a circle around the origin, 15 degrees apart, looking at it.
  WithoutTracksTest() {
    for (int i = 0; i < kNumImages; ++i) {
      const double half = i * 7.5 * 3.14159265358979323846 / 180;
      files_.AddImagePose(
          fmt::format("{}.jpg", i),
          fmt::format("{} 0 {} 0 0 0 8", std::cos(half), std::sin(half)));
    }
    for (int i = 0; i < kNumImages; ++i)
      cfg_ += fmt::format("{}.jpg\n__auto__, 4\n", i);
  }

  void ExpectNeighboursAsSources() {
    files_.WriteCfg(cfg_);
    const auto problems = ReadProblems(files_.Open(), {}, files_.Log());
    ASSERT_EQ(problems.size(), static_cast<size_t>(kNumImages));
    for (const StereoProblem& problem : problems) {
      ASSERT_EQ(problem.src_images.size(), 4u);
      for (const int source : problem.src_images) {
        const int steps = std::abs(source - problem.ref_image);
        EXPECT_LE(std::min(steps, kNumImages - steps), 3);
      }
      EXPECT_LT(problem.depth_min, 7);
      EXPECT_GT(problem.depth_max, 9);
      EXPECT_LT(problem.depth_max, 100);
      EXPECT_FALSE(problem.shares_points);
    }
    EXPECT_THAT(files_.Warnings(),
                ElementsAre(HasSubstr("24 reference images (the first: 0.jpg)"),
                            HasSubstr("Fusion will find nothing")));
  }

  static constexpr int kNumImages = 24;
  TestWorkspace files_;
  std::string cfg_;
};

TEST_F(WithoutTracksTest, PointsTellSourcesAndRanges) {
  for (int i = 0; i < 300; ++i)
    files_.AddPoint({std::cos(i), std::cos(2.1 * i), std::sin(i)}, {});
  ExpectNeighboursAsSources();
}

TEST_F(WithoutTracksTest, WithoutPointsThePosesDo) {
  ExpectNeighboursAsSources();
}

TEST_F(WithoutTracksTest, AnImageWithoutTracksHelpsTheOthers) {
  for (int i = 0; i < 300; ++i) {
    files_.AddPoint(
        {std::cos(i), std::cos(2.1 * i), std::sin(i)},
        i % 2 == 0 ? std::vector<int>{} : std::vector<int>{5, 6, 8});
  }
  files_.WriteCfg("6.jpg\n__auto__, 4\n8.jpg\n__auto__, 2\n");
  const auto problems = ReadProblems(files_.Open(), {}, files_.Log());
  ASSERT_EQ(problems.size(), 2u);
  // Those that share tracks come first, and are all if they are enough.
  EXPECT_THAT(problems[0].src_images, ElementsAre(5, 8, 7, testing::_));
  EXPECT_THAT(problems[1].src_images, ElementsAre(5, 6));
  EXPECT_THAT(files_.Warnings(), IsEmpty());
}

TEST_F(WithoutTracksTest, TheNumberOfSourcesIsMetWithImagesThatHaveAPicture) {
  for (const char* name : {"5.jpg", "7.jpg"}) files_.LeaveOutFile(name);
  files_.WriteCfg("6.jpg\n__auto__, 4\n5.jpg\n__auto__, 4\n");
  const Workspace workspace = files_.Open();
  const auto problems = ReadProblems(workspace, {}, files_.Log());
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_THAT(problems[0].src_images,
              testing::UnorderedElementsAre(3, 4, 8, 9));
  EXPECT_EQ(problems[1].src_images.size(), 4u);
  EXPECT_FALSE(CanBeComputed(workspace, problems[1]));
}

TEST_F(WithoutTracksTest, WantedSourcesDoNotDependOnPictures) {
  files_.WriteCfg("6.jpg\n__auto__, 4\n5.jpg\n__auto__, 4\n");
  Workspace workspace = files_.Open();
  const auto before = ReadProblems(workspace, {}, nullptr);
  for (const int image : {5, 7}) workspace.DropPicture(image);
  const auto after = ReadProblems(workspace, {}, nullptr);
  for (const int p : {0, 1}) {
    EXPECT_EQ(before[p].wanted_sources, before[p].src_images);
    EXPECT_EQ(after[p].wanted_sources, before[p].wanted_sources);
    EXPECT_NE(after[p].src_images, before[p].src_images);
  }
}

TEST_F(WithoutTracksTest, TracksOfOneImageDoNotHelpFusion) {
  for (int i = 0; i < 20 * kNumImages; ++i) {
    files_.AddPoint({std::cos(i), std::cos(2.1 * i), std::sin(i)},
                    {i % kNumImages});
  }
  files_.WriteCfg(cfg_);
  EXPECT_EQ(ReadProblems(files_.Open(), {}, files_.Log()).size(),
            static_cast<size_t>(kNumImages));
  EXPECT_THAT(files_.Warnings(),
              ElementsAre(HasSubstr("Fusion will find nothing")));
}

}  // namespace
}  // namespace hpm
