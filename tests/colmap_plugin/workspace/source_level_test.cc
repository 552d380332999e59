#include "colmap_plugin/workspace/source_level.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

namespace hpm {
namespace {

// Image 0, of 160 x 120 pixels and f = 100, looks along z on depths about 10.
class SourceLevelTest : public testing::Test {
 protected:
  SourceLevelTest() {
    workspace_.AddImage("ref.png", {0, 0, 0});
    problem_.ref_image = 0;
    problem_.depth_min = 8;
    problem_.depth_max = 12.5f;
  }

  int LevelOf(const std::string& camera, const Eigen::Vector3d& center) {
    const int id = 2 + num_sources_++;
    workspace_.AddCamera(id, camera);
    const int src =
        workspace_.AddImage(fmt::format("src{}.png", id), center, id);
    return SourceLevel(workspace_.Open(), problem_, src);
  }

  TestWorkspace workspace_;
  StereoProblem problem_;
  int num_sources_ = 0;
};

constexpr const char* kSame = "PINHOLE 160 120 100 100 80 60";

TEST_F(SourceLevelTest, AnImageLikeTheReferenceStaysAsItIs) {
  EXPECT_EQ(LevelOf(kSame, {1, 0, 0}), 0);
}

TEST_F(SourceLevelTest, OneALittleFinerStaysAsItIs) {
  EXPECT_EQ(LevelOf("PINHOLE 160 120 140 140 80 60", {1, 0, 0}), 0);
}

TEST_F(SourceLevelTest, OneOfTwiceTheZoomIsHalved) {
  EXPECT_EQ(LevelOf("PINHOLE 160 120 200 200 80 60", {1, 0, 0}), 1);
}

TEST_F(SourceLevelTest, OneOfFourTimesTheSizeIsHalvedTwice) {
  EXPECT_EQ(LevelOf("PINHOLE 640 480 400 400 320 240", {1, 0, 0}), 2);
}

TEST_F(SourceLevelTest, OneFromHalfTheDistanceIsHalved) {
  EXPECT_EQ(LevelOf(kSame, {1, 0, 5}), 1);
}

// Finer by 1.7 at the nearest depth, 1.5 in the middle, 1.4 at the farthest.
TEST_F(SourceLevelTest, OneThatIsFinerAtMostDepthsIsHalved) {
  EXPECT_EQ(LevelOf(kSame, {1, 0, 3.4}), 1);
}

TEST_F(SourceLevelTest, CoarserOnesStayAsTheyAre) {
  EXPECT_EQ(LevelOf("PINHOLE 80 60 50 50 40 30", {1, 0, 0}), 0);
  EXPECT_EQ(LevelOf(kSame, {1, 0, -10}), 0);
}

TEST_F(SourceLevelTest, OneThatSeesNothingOfItStaysAsItIs) {
  EXPECT_EQ(LevelOf("PINHOLE 160 120 400 400 80 60", {100, 0, 0}), 0);
  EXPECT_EQ(LevelOf("PINHOLE 160 120 400 400 80 60", {0, 0, 100}), 0);
}

TEST_F(SourceLevelTest, SomeOfTheImageIsLeft) {
  EXPECT_EQ(LevelOf("PINHOLE 160 120 1000 1000 80 60", {0, 0, 0}), 2);
}

// Coordinates of this size have no digits left for a metre in a float.
TEST_F(SourceLevelTest, FarFromTheOriginItIsTheSame) {
  const Eigen::Vector3d far = {4e9, 5e9, 0};
  const int ref = workspace_.AddImage("far_ref.png", far);
  problem_.ref_image = ref;
  EXPECT_EQ(LevelOf(kSame, far + Eigen::Vector3d(1, 0, 5)), 1);
}

}  // namespace
}  // namespace hpm
