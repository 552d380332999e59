#include "colmap_plugin/controller/stage_runner.h"

#include "colmap_plugin/options/method_options.h"
#include "src/cpu/cpu_backend.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

// Writes down the calls and hands them on to the CPU.
class RecordingBackend : public Backend {
 public:
  std::string Name() const override { return cpu_->Name(); }
  uint64_t MemoryNeeded(int width, int height, int num_srcs) const override {
    return cpu_->MemoryNeeded(width, height, num_srcs);
  }
  void SetViews(const ViewSet& views, const MethodParams& params) override {
    calls.emplace_back("set");
    views_set = views;
    cpu_->SetViews(views, params);
  }
  void ForgetViews() override {
    calls.emplace_back("forget");
    cpu_->ForgetViews();
  }
  void Run(const Pass& pass,
           const SamplingPattern& pattern,
           HypothesisMap* map,
           const RunControl& control) override {
    calls.emplace_back("run");
    cpu_->Run(pass, pattern, map, control);
  }
  std::vector<float> Score(const std::vector<PixelPlane>& planes,
                           const RunControl& control) override {
    return cpu_->Score(planes, control);
  }
  std::vector<uint32_t> ConsistentViews(const HypothesisMap& map,
                                        const FilterParams& filter,
                                        bool geometric,
                                        const RunControl& control) override {
    calls.emplace_back("filter");
    return cpu_->ConsistentViews(map, filter, geometric, control);
  }
  uint64_t num_cost_evaluations() const override {
    return cpu_->num_cost_evaluations();
  }

  std::vector<std::string> calls;
  ViewSet views_set;

 private:
  std::unique_ptr<Backend> cpu_ = MakeCpuBackend("auto", 1);
};

// The stages of one image with the sources 1 and 2.
class StageRunnerTest : public testing::Test {
 protected:
  // The photometric stage, and with `geometric` the one after it, of all three
  // images.
  void Run(const SceneWorkspace& scene, bool geometric) {
    const Workspace workspace = scene.Open();
    std::vector<StereoProblem> problems;
    for (int image = 0; image < 3; ++image) {
      StereoProblem problem;
      problem.ref_image = image;
      problem.src_images = {(image + 1) % 3, (image + 2) % 3};
      problem.depth_min = 3;
      problem.depth_max = 8;
      problems.push_back(problem);
    }
    ControllerOptions options;
    options.workspace.path = scene.path();
    options.hpm.method = "nesp";
    options.patch_match.geom_consistency = geometric;
    const Schedule schedule = MakeSchedule(MakeScheduleOptions(options));
    ImageContents contents(workspace);
    CancelToken cancel;
    const StagePlan plan(
        workspace, problems, schedule, options, &contents, cancel);
    const LogSink log = [](LogLevel, const std::string&) {};
    InputCache inputs(workspace, 1 << 20, /*max_decodes=*/2);
    const RunLock lock(workspace.StatePath(), log, &cancel);
    StageRunner runner(workspace,
                       problems,
                       schedule,
                       options,
                       plan,
                       lock,
                       &inputs,
                       &backend_,
                       log);
    for (int problem = geometric ? 2 : 0; problem >= 0; --problem) {
      backend_.calls.clear();
      runner.Run(0, problem, {&cancel, nullptr});
    }
    if (geometric) runner.Run(1, 0, {&cancel, nullptr});
  }

  RecordingBackend backend_;
};

// A problem's images must not be in memory beside those of the next.
TEST_F(StageRunnerTest, ForgetsTheViewsWhenTheImageIsDone) {
  Run(SceneWorkspace(SmallScene(3, 24, 18)), false);
  EXPECT_THAT(backend_.calls,
              testing::ElementsAre("set", "run", "filter", "forget"));
}

// Camera, image and depth map alike.
TEST_F(StageRunnerTest, HalvesASourceOfTwiceTheResolution) {
  TestScene scene = MakeTiltedPlane(SmallScene(3, 48, 36));
  Camera& fine = scene.cameras[2];
  fine.width *= 2;
  fine.height *= 2;
  fine.fx *= 2;
  fine.fy *= 2;
  fine.cx = 2 * fine.cx + 0.5f;
  fine.cy = 2 * fine.cy + 0.5f;
  Run(SceneWorkspace(scene), true);
  for (const View& src : backend_.views_set.srcs) {
    EXPECT_EQ(src.camera.width, 48);
    EXPECT_EQ(src.camera.height, 36);
    EXPECT_EQ(src.image->width, 48);
    EXPECT_EQ(src.image->height, 36);
    ASSERT_NE(src.inverse_depth, nullptr);
    EXPECT_EQ(src.inverse_depth->steps.size(),
              48u * 36 * kInverseDepthBytes + 1);
    EXPECT_NEAR(src.camera.fx, backend_.views_set.ref.camera.fx, 1e-3);
    EXPECT_NEAR(src.camera.cx, backend_.views_set.ref.camera.cx, 1e-3);
  }
}

}  // namespace
}  // namespace hpm
