#include "colmap_plugin/controller/input_cache.h"

#include "colmap_plugin/controller/ray_convention.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 30;
constexpr int kHeight = 20;
constexpr uint64_t kImageBytes = kWidth * kHeight;
constexpr uint64_t kPlenty = 100 * kImageBytes;

class InputCacheTest : public testing::Test {
 protected:
  InputCache MakeCache(uint64_t max_bytes) {
    return InputCache(workspace_, max_bytes);
  }

  StageFiles WriteTruth(int image) {
    const Camera& camera = workspace_.camera(image);
    HypothesisMap map(kWidth, kHeight);
    const TrueMaps& truth = scene_.views()[image].truth;
    for (int i = 0; i < kWidth * kHeight; ++i) {
      map.planes[i] = PlaneFromDepth(camera,
                                     static_cast<float>(i % kWidth),
                                     static_cast<float>(i / kWidth),
                                     truth.depth[i],
                                     truth.normals[i]);
    }
    const DepthAndNormal maps = ToColmapMaps(map, camera);
    const StageFiles files = {
        workspace_.MapPath(image, MapKind::kDepth, "photometric"),
        workspace_.MapPath(image, MapKind::kNormal, "photometric"),
        {}};
    WriteMap(files.depth, maps.depth);
    WriteMap(files.normal, maps.normal);
    return files;
  }

  SceneWorkspace scene_{SmallScene(3, kWidth, kHeight)};
  Workspace workspace_ = scene_.Open();
};

TEST_F(InputCacheTest, ReadsAnImageOnce) {
  InputCache cache = MakeCache(kPlenty);
  const auto first = cache.Image(1);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->width, kWidth);
  EXPECT_EQ(first->height, kHeight);
  std::filesystem::remove(workspace_.ImagePath(1));
  EXPECT_EQ(cache.Image(1), first);
}

TEST_F(InputCacheTest, ReadsAgainWhatDidNotFit) {
  InputCache cache = MakeCache(kImageBytes - 1);
  ASSERT_NE(cache.Image(1), nullptr);
  std::filesystem::remove(workspace_.ImagePath(1));
  EXPECT_THROW(cache.Image(1), UnreadableImage);
}

TEST_F(InputCacheTest, AStageGetsImagesOfItsLevel) {
  InputCache cache = MakeCache(kPlenty);
  cache.StartStage(1);
  const auto half = cache.Image(1);
  ASSERT_NE(half, nullptr);
  const Camera camera = LevelCamera(workspace_.camera(1), 1);
  EXPECT_EQ(half->width, camera.width);
  EXPECT_EQ(half->height, camera.height);
  EXPECT_EQ(cache.Image(1), half);
  cache.StartStage(0);
  const auto full = cache.Image(1);
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(full->width, kWidth);
}

TEST_F(InputCacheTest, ASourceMayBeHalvedMoreThanTheStage) {
  InputCache cache = MakeCache(kPlenty);
  cache.StartStage(1);
  const auto of_stage = cache.Image(1);
  const auto coarser = cache.Image(1, 1);
  ASSERT_NE(coarser, nullptr);
  const Camera camera = LevelCamera(workspace_.camera(1), 2);
  EXPECT_EQ(coarser->width, camera.width);
  EXPECT_EQ(coarser->height, camera.height);
  EXPECT_EQ(cache.Image(1), of_stage);
  EXPECT_EQ(cache.Image(1, 1), coarser);
}

TEST_F(InputCacheTest, AnUnreadableImageIsNamed) {
  std::filesystem::resize_file(workspace_.ImagePath(2), 60);
  InputCache cache = MakeCache(kPlenty);
  try {
    cache.Image(2);
    ADD_FAILURE();
  } catch (const UnreadableImage& error) {
    EXPECT_EQ(error.image(), 2);
    EXPECT_EQ(error.code(), ErrorCode::kBadInput);
    EXPECT_THAT(error.what(), testing::HasSubstr(ViewName(2)));
  }
  EXPECT_NE(cache.Image(1), nullptr);
}

TEST_F(InputCacheTest, InverseDepthIsThatOfTheFilesAtPixelCentres) {
  const StageFiles files = WriteTruth(0);
  InputCache cache = MakeCache(kPlenty);
  const auto inverse = cache.InverseDepth(0, workspace_.camera(0), files);
  ASSERT_NE(inverse, nullptr);
  for (int i = 0; i < kWidth * kHeight; ++i) {
    EXPECT_NEAR(inverse->step * InverseDepthSteps(inverse->steps.data(), i) *
                    scene_.views()[0].truth.depth[i],
                1,
                1e-5);
  }
}

TEST_F(InputCacheTest, InverseDepthOfAHalvedSourceHasTheSizeOfItsCamera) {
  const StageFiles files = WriteTruth(0);
  const Camera& camera = workspace_.camera(0);
  const Camera half = LevelCamera(camera, 1);
  InputCache cache = MakeCache(kPlenty);
  const auto full = cache.InverseDepth(0, camera, files);
  const auto halved = cache.InverseDepth(0, camera, files, 1);
  ASSERT_NE(halved, nullptr);
  EXPECT_EQ(
      halved->steps.size(),
      static_cast<size_t>(kInverseDepthBytes) * half.width * half.height + 1);
  EXPECT_EQ(cache.InverseDepth(0, camera, files), full);
}

TEST_F(InputCacheTest, DepthIsReadOnceUntilForgotten) {
  const StageFiles files = WriteTruth(0);
  const Camera& camera = workspace_.camera(0);
  InputCache cache = MakeCache(kPlenty);
  const auto first = cache.InverseDepth(0, camera, files);
  std::filesystem::remove(files.depth);
  EXPECT_EQ(cache.InverseDepth(0, camera, files), first);
  cache.StartStage(0);
  EXPECT_EQ(cache.InverseDepth(0, camera, files), nullptr);
}

TEST_F(InputCacheTest, DamagedMapsGiveNoDepth) {
  const Camera& camera = workspace_.camera(0);
  StageFiles files = WriteTruth(0);
  std::filesystem::resize_file(files.depth, 100);
  EXPECT_EQ(MakeCache(kPlenty).InverseDepth(0, camera, files), nullptr);
  files = WriteTruth(0);
  std::filesystem::remove(files.normal);
  EXPECT_EQ(MakeCache(kPlenty).InverseDepth(0, camera, files), nullptr);
  files = WriteTruth(0);
  WriteMap(files.depth, {2, 2, 1, {1, 1, 1, 1}});  // another size
  EXPECT_EQ(MakeCache(kPlenty).InverseDepth(0, camera, files), nullptr);
}

}  // namespace
}  // namespace hpm
