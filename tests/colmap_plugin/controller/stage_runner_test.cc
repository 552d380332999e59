#include "colmap_plugin/controller/stage_runner.h"

#include "colmap_plugin/controller/method_options.h"
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

 private:
  std::unique_ptr<Backend> cpu_ = MakeCpuBackend("auto", 1);
};

// A problem's images must not be in memory beside those of the next.
TEST(StageRunner, ForgetsTheViewsWhenTheImageIsDone) {
  const SceneWorkspace scene(SmallScene(3, 24, 18));
  const Workspace workspace = scene.Open();
  StereoProblem problem;
  problem.ref_image = 0;
  problem.src_images = {1, 2};
  problem.depth_min = 3;
  problem.depth_max = 8;
  const std::vector<StereoProblem> problems = {problem};
  ControllerOptions options;
  options.workspace.path = scene.path();
  options.hpm.method = "nesp";
  options.patch_match.geom_consistency = false;
  const Schedule schedule = MakeSchedule(MakeScheduleOptions(options));
  const StagePlan plan(workspace, problems, schedule, options);
  const LogSink log = [](LogLevel, const std::string&) {};
  InputCache inputs(workspace, 1 << 20);
  RecordingBackend backend;
  CancelToken cancel;
  const RunLock lock(workspace.StatePath(), log, &cancel);
  StageRunner runner(workspace,
                     problems,
                     schedule,
                     options,
                     plan,
                     lock,
                     &inputs,
                     &backend,
                     log);
  runner.Run(0, 0, {&cancel, nullptr});
  EXPECT_THAT(backend.calls,
              testing::ElementsAre("set", "run", "filter", "forget"));
}

}  // namespace
}  // namespace hpm
