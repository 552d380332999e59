#include "bench/eval/depth_eval.h"

#include "colmap_plugin/formats/map_file.h"
#include "src/base/error.h"
#include "tests/scenes/workspace_writer.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

class DepthEval : public testing::Test {
 protected:
  void SetUp() override {
    options_.workspace =
        std::filesystem::path(testing::TempDir()) /
        testing::UnitTest::GetInstance()->current_test_info()->name();
    options_.truth = options_.workspace / "gt";
    std::filesystem::remove_all(options_.workspace);
  }
  void TearDown() override { std::filesystem::remove_all(options_.workspace); }

  void WriteScene(const std::string& name) {
    SceneOptions scene_options;
    scene_options.num_views = 2;
    scene_options.width = 80;
    scene_options.height = 60;
    const TestScene scene = MakeScene(name, scene_options);
    WriteWorkspace(scene, options_.workspace);
    WriteTruthAsMaps(scene, options_.workspace, options_.stage);
  }
  std::filesystem::path MapPath(const std::string& kind, int view) {
    return options_.workspace / "stereo" / kind /
           (ViewName(view) + ".geometric.bin");
  }

  DepthEvaluationOptions options_;
};

TEST_F(DepthEval, TruthOnColmapsRaysHasNoErrorUnderColmapsRule) {
  WriteScene("tilted_plane");
  const DepthEvaluation result = EvaluateDepth(options_);
  EXPECT_EQ(result.num_images, 2);
  EXPECT_EQ(result.all.num_pixels, 2u * 80 * 60);
  EXPECT_EQ(result.all.density, 1);
  EXPECT_LT(result.all.median_relative_error, 1e-5);
  EXPECT_LT(result.all.median_normal_error, 0.05);
  EXPECT_EQ(result.all.within[0], 1);
}

TEST_F(DepthEval, TheSameMapsAreOffUnderTheCenterRuleOnASlantedSurface) {
  WriteScene("tilted_plane");
  options_.rule = PixelRule::kCenter;
  const DepthEvaluation result = EvaluateDepth(options_);
  EXPECT_GT(result.all.median_relative_error, 1e-4);
}

TEST_F(DepthEval, HolesCountAsWrongButNotAgainstTheEstimatedPixels) {
  WriteScene("tilted_plane");
  Map depth = ReadMap(MapPath("depth_maps", 0));
  for (size_t i = 0; i < depth.data.size() / 2; ++i) depth.data[i] = 0;
  WriteMap(MapPath("depth_maps", 0), depth);
  const DepthEvaluation result = EvaluateDepth(options_);
  EXPECT_EQ(result.all.density, 0.75);
  EXPECT_EQ(result.all.within[5], 0.75);
  EXPECT_EQ(result.all.within_estimated[5], 1);
}

TEST_F(DepthEval, ThreePercentOffCountsOnlyWithinFivePercent) {
  WriteScene("tilted_plane");
  for (int view = 0; view < 2; ++view) {
    Map depth = ReadMap(MapPath("depth_maps", view));
    for (float& z : depth.data) z *= 1.03f;
    WriteMap(MapPath("depth_maps", view), depth);
  }
  const DepthEvaluation result = EvaluateDepth(options_);
  EXPECT_NEAR(result.all.median_relative_error, 0.03, 1e-4);
  EXPECT_EQ(result.all.within[4], 0);
  EXPECT_EQ(result.all.within[5], 1);
}

TEST_F(DepthEval, FlippedNormalsAreOffByHalfATurn) {
  WriteScene("tilted_plane");
  for (int view = 0; view < 2; ++view) {
    Map normals = ReadMap(MapPath("normal_maps", view));
    for (float& value : normals.data) value = -value;
    WriteMap(MapPath("normal_maps", view), normals);
  }
  EXPECT_NEAR(EvaluateDepth(options_).all.median_normal_error, 180, 0.1);
}

TEST_F(DepthEval, AMissingMapCountsAsEmpty) {
  WriteScene("tilted_plane");
  std::filesystem::remove(MapPath("depth_maps", 1));
  const DepthEvaluation result = EvaluateDepth(options_);
  EXPECT_EQ(result.num_missing_maps, 1);
  EXPECT_EQ(result.all.density, 0.5);
}

TEST_F(DepthEval, PixelsSplitIntoLowTexturedAndRest) {
  WriteScene("low_texture_wall");
  const DepthEvaluation result = EvaluateDepth(options_);
  EXPECT_GT(result.low_texture.num_pixels, result.all.num_pixels / 4);
  EXPECT_GT(result.rest.num_pixels, result.all.num_pixels / 4);
  EXPECT_EQ(result.low_texture.num_pixels + result.rest.num_pixels,
            result.all.num_pixels);
}

TEST_F(DepthEval, AMapOfAnotherSizeIsAnErrorThatNamesIt) {
  WriteScene("tilted_plane");
  WriteMap(MapPath("depth_maps", 1), Map{2, 2, 1, {1, 1, 1, 1}});
  try {
    EvaluateDepth(options_);
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kBadInput);
    EXPECT_NE(std::string(error.what()).find(ViewName(1)), std::string::npos);
  }
}

TEST_F(DepthEval, NoGroundTruthIsAnError) {
  WriteScene("tilted_plane");
  options_.truth = options_.workspace / "nowhere";
  EXPECT_THROW(EvaluateDepth(options_), Error);
}

}  // namespace
}  // namespace hpm
