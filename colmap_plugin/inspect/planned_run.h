// The plan of a run without the run: what plan, check and status look at.
#pragma once

#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/options/options.h"
#include "src/base/cancel.h"
#include "src/base/log.h"

#include <memory>
#include <vector>

namespace hpm {

class PlannedRun {
 public:
  // Reads the workspace. Throws as the run would, here and below.
  PlannedRun(const ControllerOptions& options,
             const LogSink& log,
             const CancelToken& cancel);

  // Leaves out images whose files end too early, as the run does once it has
  // decoded them. Before Plan().
  void DropTruncatedImages(const LogSink& log);

  // Finds the problems and stages. look_at_maps: else all maps count as absent.
  // access: kInspect or kVerify, so that no file is changed.
  void Plan(bool look_at_maps,
            const LogSink& log,
            PlanAccess access = PlanAccess::kInspect);

  // Levels and image size as the run has them.
  const ControllerOptions& options() const { return options_; }
  const Workspace& workspace() const { return workspace_; }
  const std::vector<StereoProblem>& problems() const { return problems_; }
  int num_references() const { return num_references_; }
  const StagePlan& plan() const { return *plan_; }

  // Of all that is to be computed: iterations times pixels.
  double Work() const;

 private:
  ControllerOptions options_;
  const CancelToken& cancel_;
  Workspace workspace_;
  ImageContents contents_;
  std::vector<StereoProblem> problems_;
  int num_references_ = 0;
  std::unique_ptr<StagePlan> plan_;
};

}  // namespace hpm
