#include "colmap_plugin/controller/input_cache.h"

#include "src/base/platform/memory.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"
#include "tests/colmap_plugin/controller/written_maps.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hpm {
namespace {

constexpr int kWidth = 30;
constexpr int kHeight = 20;
constexpr uint64_t kImageBytes = kWidth * kHeight;
constexpr uint64_t kPlenty = 100 * kImageBytes;

class InputCacheTest : public testing::Test {
 protected:
  InputCache MakeCache(uint64_t max_bytes) {
    return InputCache(workspace_, max_bytes, /*max_decodes=*/4);
  }

  static std::shared_ptr<const GrayImage> Image(InputCache* cache,
                                                int image,
                                                int more_levels = 0) {
    return cache->Images({{image, more_levels}}).front();
  }

  // Of image 0.
  std::shared_ptr<const InverseDepthMap> Depth(InputCache* cache,
                                               const StageFiles& files,
                                               int more_levels = 0) {
    return cache->InverseDepths({{0, workspace_.camera(0), files, more_levels}})
        .front();
  }
  std::shared_ptr<const InverseDepthMap> Depth(const StageFiles& files) {
    InputCache cache = MakeCache(kPlenty);
    return Depth(&cache, files);
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
    const StageFiles files = {
        workspace_.MapPath(image, MapKind::kDepth, "photometric"),
        workspace_.MapPath(image, MapKind::kNormal, "photometric"),
        {},
        {}};
    WriteMaps(map, camera, files.depth, files.normal);
    return files;
  }

  SceneWorkspace scene_{SmallScene(3, kWidth, kHeight)};
  Workspace workspace_ = scene_.Open();
};

TEST_F(InputCacheTest, ReadsAnImageOnce) {
  InputCache cache = MakeCache(kPlenty);
  const auto first = Image(&cache, 1);
  ASSERT_NE(first, nullptr);
  EXPECT_EQ(first->width, kWidth);
  EXPECT_EQ(first->height, kHeight);
  std::filesystem::remove(workspace_.ImagePath(1));
  EXPECT_EQ(Image(&cache, 1), first);
}

TEST_F(InputCacheTest, ReadsAgainWhatDidNotFit) {
  InputCache cache = MakeCache(kImageBytes - 1);
  ASSERT_NE(Image(&cache, 1), nullptr);
  std::filesystem::remove(workspace_.ImagePath(1));
  EXPECT_THROW(Image(&cache, 1), UnreadableImages);
}

TEST_F(InputCacheTest, WhatIsLoadedDropsNothingElseThatIsAskedFor) {
  InputCache cache(workspace_, 2 * kImageBytes, /*max_decodes=*/1);
  const auto first = Image(&cache, 0);
  Image(&cache, 1);
  std::filesystem::remove(workspace_.ImagePath(0));
  EXPECT_EQ(cache.Images({{2, 0}, {0, 0}}).back(), first);
}

TEST_F(InputCacheTest, AskingAgainAndAgainTakesNoMoreMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers keep what is freed for a while";
#endif
  InputCache cache(workspace_, /*max_bytes=*/0, /*max_decodes=*/2);
  tbb::task_arena of_backend(2);
  const auto read_and_match = [&] {
    for (int i = 0; i < 1500; ++i) {
      cache.Images({{0, 0}, {1, 0}, {2, 0}});
      of_backend.execute([] {
        std::atomic<int> sum{0};
        tbb::parallel_for(0, 20000, [&](int k) { sum += k; });
      });
    }
  };
  read_and_match();
  const uint64_t before = PeakMemoryBytes();
  read_and_match();
  EXPECT_LT(PeakMemoryBytes() - before, 4u << 20);
}

TEST_F(InputCacheTest, CountsWhatItReads) {
  const StageFiles files = WriteTruth(0);
  InputCache cache = MakeCache(kPlenty);
  cache.Images({{0, 0}, {1, 0}, {1, 1}});
  cache.Images({{0, 0}, {2, 1}});
  Depth(&cache, files);
  Depth(&cache, files);
  EXPECT_EQ(cache.counts().images, 3u);
  EXPECT_EQ(cache.counts().depth_maps, 1u);
}

TEST_F(InputCacheTest, AStageGetsImagesOfItsLevel) {
  InputCache cache = MakeCache(kPlenty);
  cache.StartStage(1);
  const auto half = Image(&cache, 1);
  ASSERT_NE(half, nullptr);
  const Camera camera = LevelCamera(workspace_.camera(1), 1);
  EXPECT_EQ(half->width, camera.width);
  EXPECT_EQ(half->height, camera.height);
  EXPECT_EQ(Image(&cache, 1), half);
  cache.StartStage(0);
  const auto full = Image(&cache, 1);
  ASSERT_NE(full, nullptr);
  EXPECT_EQ(full->width, kWidth);
}

TEST_F(InputCacheTest, ASourceMayBeHalvedMoreThanTheStage) {
  InputCache cache = MakeCache(kPlenty);
  cache.StartStage(1);
  const auto of_stage = Image(&cache, 1);
  const auto coarser = Image(&cache, 1, 1);
  ASSERT_NE(coarser, nullptr);
  const Camera camera = LevelCamera(workspace_.camera(1), 2);
  EXPECT_EQ(coarser->width, camera.width);
  EXPECT_EQ(coarser->height, camera.height);
  EXPECT_EQ(Image(&cache, 1), of_stage);
  EXPECT_EQ(Image(&cache, 1, 1), coarser);
}

TEST_F(InputCacheTest, AFileIsDecodedOnceForAllStages) {
  InputCache cache = MakeCache(kPlenty);
  cache.StartStage(2);
  Image(&cache, 1);
  std::filesystem::remove(workspace_.ImagePath(1));
  for (const int level : {1, 0, 0}) {
    cache.StartStage(level);
    EXPECT_EQ(Image(&cache, 1)->width, kWidth >> level);
  }
}

// The first to have no room is what only later stages need.
TEST_F(InputCacheTest, ImagesOfLaterStagesTakeNoRoomFromThoseOfThis) {
  constexpr uint64_t kHalfBytes = kImageBytes / 4;
  InputCache cache = MakeCache(kImageBytes + kHalfBytes);
  cache.StartStage(1);
  const auto first = Image(&cache, 0);
  for (const int image : {1, 2}) Image(&cache, image);
  std::filesystem::remove(workspace_.ImagePath(0));
  EXPECT_EQ(Image(&cache, 0), first);
  cache.StartStage(0);
  EXPECT_THROW(Image(&cache, 0), UnreadableImages);
}

TEST_F(InputCacheTest, ThreadsShareWhatOneOfThemReads) {
  constexpr int kFactor = 60;  // so that decoding takes a while
  constexpr int kNumThreads = 4;
  for (int image = 0; image < 3; ++image) {
    cv::imwrite(workspace_.ImagePath(image).string(),
                cv::Mat(kFactor * kHeight,
                        kFactor * kWidth,
                        CV_8UC3,
                        cv::Scalar::all(100 + image)));
  }
  InputCache cache = MakeCache(kPlenty);
  cache.StartStage(1);
  std::vector<std::vector<std::shared_ptr<const GrayImage>>> got(kNumThreads);
  std::vector<std::thread> threads;
  threads.reserve(kNumThreads);
  for (auto& images : got) {
    threads.emplace_back([&cache, &images] {
      images = cache.Images({{0, 0}, {1, 0}, {1, 1}, {2, 0}});
    });
  }
  for (std::thread& thread : threads) thread.join();
  for (const auto& images : got) EXPECT_EQ(images, got.front());
  for (int i = 0; i < 4; ++i) {
    const int image = std::vector<int>{0, 1, 1, 2}[i];
    EXPECT_EQ(got[0][i]->at(0, 0), 100 + image);
  }
}

TEST_F(InputCacheTest, AllUnreadableImagesAreNamed) {
  for (const int image : {1, 2})
    std::filesystem::resize_file(workspace_.ImagePath(image), 60);
  InputCache cache = MakeCache(kPlenty);
  // A second thread begins in the middle.
  std::vector<ImageRequest> requests(16);
  requests[7].image = 2;
  requests[8].image = 1;
  try {
    cache.Images(requests);
    ADD_FAILURE();
  } catch (const UnreadableImages& error) {
    EXPECT_THAT(error.reasons(),
                testing::ElementsAre(
                    testing::Pair(1, testing::HasSubstr(ViewName(1))),
                    testing::Pair(2, testing::HasSubstr(ViewName(2)))));
  }
}

TEST_F(InputCacheTest, AnUnreadableImageIsNamed) {
  std::filesystem::resize_file(workspace_.ImagePath(2), 60);
  InputCache cache = MakeCache(kPlenty);
  try {
    Image(&cache, 2);
    ADD_FAILURE();
  } catch (const UnreadableImages& error) {
    EXPECT_EQ(error.reasons().begin()->first, 2);
    EXPECT_EQ(error.code(), ErrorCode::kBadInput);
    EXPECT_THAT(error.what(), testing::HasSubstr(ViewName(2)));
  }
  EXPECT_NE(Image(&cache, 1), nullptr);
}

TEST_F(InputCacheTest, InverseDepthIsThatOfTheFilesAtPixelCentres) {
  const StageFiles files = WriteTruth(0);
  InputCache cache = MakeCache(kPlenty);
  const auto inverse = Depth(&cache, files);
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
  const auto full = Depth(&cache, files);
  const auto halved = Depth(&cache, files, 1);
  ASSERT_NE(halved, nullptr);
  EXPECT_EQ(
      halved->steps.size(),
      static_cast<size_t>(kInverseDepthBytes) * half.width * half.height + 1);
  EXPECT_EQ(Depth(&cache, files), full);
}

TEST_F(InputCacheTest, DepthIsReadOnceUntilForgotten) {
  const StageFiles files = WriteTruth(0);
  InputCache cache = MakeCache(kPlenty);
  const auto first = Depth(&cache, files);
  std::filesystem::remove(files.depth);
  EXPECT_EQ(Depth(&cache, files), first);
  cache.ForgetDepths();
  EXPECT_EQ(Depth(&cache, files), nullptr);
}

TEST_F(InputCacheTest, DamagedMapsGiveNoDepth) {
  StageFiles files = WriteTruth(0);
  std::filesystem::resize_file(files.depth, 100);
  EXPECT_EQ(Depth(files), nullptr);
  files = WriteTruth(0);
  std::filesystem::remove(files.normal);
  EXPECT_EQ(Depth(files), nullptr);
  files = WriteTruth(0);
  WriteMap(files.depth, {2, 2, 1, {1, 1, 1, 1}});  // another size
  EXPECT_EQ(Depth(files), nullptr);
}

}  // namespace
}  // namespace hpm
