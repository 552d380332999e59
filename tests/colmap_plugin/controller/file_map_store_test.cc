#include "colmap_plugin/controller/file_map_store.h"

#include "colmap_plugin/controller/engine_problems.h"
#include "colmap_plugin/options/method_options.h"
#include "src/engine/run_schedule.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"
#include "tests/engine/still_backend.h"

#include <functional>
#include <memory>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kNumImages = 3;

// What this process is to compute of what is needed.
using Share = std::function<bool(int stage, int problem)>;

class SharedStore : public FileMapStore {
 public:
  using FileMapStore::FileMapStore;
  bool IsNeeded(int stage, int problem) const override {
    return share(stage, problem) && FileMapStore::IsNeeded(stage, problem);
  }
  Share share;
};

class FileMapStoreTest : public testing::Test {
 protected:
  FileMapStoreTest() {
    options_.hpm.method = "nesp";
    options_.hpm.num_geom_passes = 1;
  }

  // A process of its own: opens the workspace and plans by what is there.
  // Returns how many problems it computed in all stages.
  int Run(
      const SceneWorkspace& scene,
      const Share& share = [](int, int) { return true; }) {
    const Workspace workspace = scene.Open();
    options_.workspace.path = scene.path();
    std::vector<StereoProblem> problems;
    for (int image = 0; image < kNumImages; ++image) {
      StereoProblem problem;
      problem.ref_image = image;
      problem.src_images = {(image + 1) % 3, (image + 2) % 3};
      problem.depth_min = 3;
      problem.depth_max = 8;
      problems.push_back(problem);
    }
    const RunSpec spec = {
        MakeSchedule(MakeScheduleOptions(options_)),
        MakeMethodParams(options_),
        MakeMapFilter(options_),
        EngineProblems(workspace, problems, options_.random_seed)};
    ImageContents contents(workspace);
    CancelToken cancel;
    const StagePlan plan(
        workspace, problems, spec.schedule, options_, &contents, cancel);
    const LogSink log = [](LogLevel, const std::string&) {};
    InputCache inputs(workspace, 1 << 20, /*max_decodes=*/2);
    const RunLock lock(workspace.StatePath(), log, &cancel);
    RunStatistics statistics;
    SharedStore store(
        workspace, problems, options_, plan, lock, &inputs, &statistics, log);
    store.share = share;
    WorkerPool workers(std::make_unique<StillBackend>(&log_));
    int num_computed = 0;
    RunEvents events;
    events.started = [&](const RunProgress&) { ++num_computed; };
    RunSchedule(spec, &inputs, &store, &workers, events);
    has_complete_maps_ = true;
    for (int image = 0; image < kNumImages; ++image)
      has_complete_maps_ &= plan.HasCompleteMaps(1, image);
    return num_computed;
  }

  ControllerOptions options_;
  StillLog log_;
  bool has_complete_maps_ = false;  // of the last stage, after the last run
};

// Camera, image and depth map alike.
TEST_F(FileMapStoreTest, HalvesASourceOfTwiceTheResolution) {
  TestScene scene = MakeTiltedPlane(SmallScene(3, 48, 36));
  Camera& fine = scene.cameras[2];
  fine.width *= 2;
  fine.height *= 2;
  fine.fx *= 2;
  fine.fy *= 2;
  fine.cx = 2 * fine.cx + 0.5f;
  fine.cy = 2 * fine.cy + 0.5f;
  Run(SceneWorkspace(scene));
  const ViewSet& views = log_.views[kNumImages];  // image 0, geometric stage
  ASSERT_EQ(views.srcs.size(), 2u);
  for (const View& src : views.srcs) {
    EXPECT_EQ(src.camera.width, 48);
    EXPECT_EQ(src.camera.height, 36);
    EXPECT_EQ(src.image->width, 48);
    EXPECT_EQ(src.image->height, 36);
    ASSERT_NE(src.inverse_depth, nullptr);
    EXPECT_EQ(src.inverse_depth->steps.size(),
              48u * 36 * kInverseDepthBytes + 1);
    EXPECT_NEAR(src.camera.fx, views.ref.camera.fx, 1e-3);
    EXPECT_NEAR(src.camera.cx, views.ref.camera.cx, 1e-3);
  }
}

TEST_F(FileMapStoreTest, WhatIsFinishedIsNotNeeded) {
  const SceneWorkspace scene(SmallScene(3, 24, 18));
  EXPECT_EQ(Run(scene), 2 * kNumImages);
  EXPECT_TRUE(has_complete_maps_);
  EXPECT_EQ(Run(scene), 0);
}

// Two processes share the first stage, a third one goes on with what they made.
TEST_F(FileMapStoreTest, AStageReadsWhatOtherProcessesMade) {
  const SceneWorkspace scene(SmallScene(3, 24, 18));
  EXPECT_EQ(Run(scene, [](int s, int p) { return s == 0 && p < 2; }), 2);
  EXPECT_EQ(Run(scene, [](int s, int p) { return s == 0 && p >= 2; }), 1);
  EXPECT_FALSE(has_complete_maps_);
  EXPECT_EQ(Run(scene, [](int s, int) { return s == 1; }), kNumImages);
  EXPECT_TRUE(has_complete_maps_);
  for (const View& src : log_.views.back().srcs)
    EXPECT_NE(src.inverse_depth, nullptr);
}

// Good enough to go on with, to be made again by the next run.
TEST_F(FileMapStoreTest, AStageWithoutTheMapsOfASourceIsIncomplete) {
  const SceneWorkspace scene(SmallScene(3, 24, 18));
  EXPECT_EQ(Run(scene, [](int, int p) { return p < 2; }), 4);
  EXPECT_FALSE(has_complete_maps_);
  EXPECT_EQ(Run(scene), 4);
  EXPECT_TRUE(has_complete_maps_);
}

TEST_F(FileMapStoreTest, RandomKeysAreOfTheSeedAndTheNameOfTheImage) {
  const SceneWorkspace scene(SmallScene(3, 24, 18));
  const Workspace workspace = scene.Open();
  StereoProblem one, other;
  one.ref_image = 1;
  other.ref_image = 2;
  const auto key_of = [&](const std::vector<StereoProblem>& problems,
                          int seed) {
    return EngineProblems(workspace, problems, seed).back().random_key;
  };
  EXPECT_EQ(key_of({one}, 5), key_of({other, one}, 5));
  EXPECT_NE(key_of({one}, 5), key_of({one}, 6));
  EXPECT_NE(key_of({one}, 5), key_of({other}, 5));
}

}  // namespace
}  // namespace hpm
