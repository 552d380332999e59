// The plan of a run over a few images, and maps as if some had been made.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/formats/consistency_graph.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/options/method_options.h"
#include "colmap_plugin/workspace/stamp.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {

constexpr int kWidth = 12;
constexpr int kHeight = 9;

// Five images in a row, each with its neighbours as sources; photometric and
// three geometric stages.
class StagePlanTest : public testing::Test {
 protected:
  StagePlanTest() {
    options_.hpm.method = "nesp";
    options_.hpm.num_levels = 1;
    options_.hpm.num_geom_passes = 3;
    for (int i = 0; i < 5; ++i) {
      StereoProblem problem;
      problem.ref_image = i;
      if (i > 0) problem.src_images.push_back(i - 1);
      if (i < 4) problem.src_images.push_back(i + 1);
      problem.depth_min = 3;
      problem.depth_max = 8;
      problems_.push_back(problem);
    }
  }

  StagePlan Plan() {
    return StagePlan(workspace_,
                     problems_,
                     MakeSchedule(MakeScheduleOptions(options_)),
                     options_,
                     &contents_,
                     cancel_);
  }

  // The problems to compute in a stage.
  std::vector<int> Needed(const StagePlan& plan, int stage) const {
    std::vector<int> needed;
    for (int p = 0; p < static_cast<int>(problems_.size()); ++p) {
      if (plan.IsNeeded(stage, p)) needed.push_back(p);
    }
    return needed;
  }

  void Finish(const StagePlan& plan, int stage, int problem) {
    const StageFiles files = plan.Files(stage, problems_[problem].ref_image);
    for (const auto& path : {files.depth, files.normal}) {
      std::filesystem::create_directories(path.parent_path());
    }
    Stamp stamp = {plan.FingerprintOf(stage, problem), {}, nullptr, {}};
    std::vector<float> data(kWidth * kHeight, 1.0f);
    stamp.files["depth"] = WriteMap(files.depth, {kWidth, kHeight, 1, data});
    data.resize(3 * data.size(), 0.5f);
    stamp.files["normal"] = WriteMap(files.normal, {kWidth, kHeight, 3, data});
    if (options_.patch_match.write_consistency_graph) {
      stamp.files["graph"] =
          WriteConsistencyGraph(files.graph, {kWidth, kHeight, {}});
    }
    const std::string& stage_name = plan.stages()[stage].name;
    const std::string& name =
        workspace_.ImageName(problems_[problem].ref_image);
    WriteStamp(workspace_.StatePath(), name, stage_name, stamp);
  }

  void FinishAll(bool inner) {
    const StagePlan plan = Plan();
    for (int s = 0; s < static_cast<int>(plan.stages().size()); ++s) {
      if (!inner && !plan.stages()[s].is_public) continue;
      for (int p = 0; p < 5; ++p) Finish(plan, s, p);
    }
  }

  std::filesystem::path DepthFile(int stage, int problem) {
    return Plan().Files(stage, problem).depth;
  }

  // Stages in which the fingerprint of problem 2 changes with the options.
  std::set<int> ChangedBy(const std::function<void()>& change) {
    const ControllerOptions options = options_;
    const std::vector<StereoProblem> problems = problems_;
    const StagePlan before = Plan();
    std::vector<std::string> old;
    for (int s = 0; s < 4; ++s) old.push_back(before.FingerprintOf(s, 2));
    change();
    const StagePlan after = Plan();
    std::set<int> changed;
    for (int s = 0; s < 4; ++s) {
      if (after.FingerprintOf(s, 2) != old[s]) changed.insert(s);
    }
    options_ = options;
    problems_ = problems;
    return changed;
  }

  SceneWorkspace scene_{SmallScene(5, kWidth, kHeight)};
  Workspace workspace_ = scene_.Open();
  ImageContents contents_{workspace_};
  CancelToken cancel_;
  ControllerOptions options_;
  std::vector<StereoProblem> problems_;
};

}  // namespace hpm
