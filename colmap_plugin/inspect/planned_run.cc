#include "colmap_plugin/inspect/planned_run.h"

#include "colmap_plugin/controller/deep_images.h"
#include "colmap_plugin/controller/run_setup.h"
#include "colmap_plugin/controller/unreadable_images.h"
#include "colmap_plugin/options/method_options.h"

namespace hpm {

PlannedRun::PlannedRun(const ControllerOptions& options,
                       const LogSink& log,
                       const CancelToken& cancel)
    : options_(options),
      cancel_(cancel),
      workspace_(options_.workspace, log, cancel),
      contents_(workspace_) {
  SetLevels(workspace_, &options_);
}

void PlannedRun::DropTruncatedImages(const LogSink& log) {
  for (const std::string& line : DropTruncated(&workspace_, cancel_))
    log(LogLevel::kWarning, line);
}

void PlannedRun::Plan(bool look_at_maps,
                      const LogSink& log,
                      PlanAccess access) {
  for (const std::string& line :
       DropUnreadable(&workspace_, &contents_, cancel_)) {
    if (log) log(LogLevel::kWarning, line);
  }
  workspace_.StretchDeepImages(
      FindDeepRange(workspace_, &contents_, log, cancel_, access));
  const ProblemOptions& problem_options = options_.problems;
  const ModelOverview overview(workspace_, problem_options, cancel_);
  problems_ = ReadProblems(workspace_, overview, problem_options, log, cancel_);
  num_references_ = static_cast<int>(problems_.size());
  CompleteProblems(workspace_, overview, options_, log, cancel_, &problems_);
  options_.hpm.overwrite |= !look_at_maps;
  plan_ =
      std::make_unique<StagePlan>(workspace_,
                                  problems_,
                                  MakeSchedule(MakeScheduleOptions(options_)),
                                  options_,
                                  &contents_,
                                  cancel_,
                                  access);
}

double PlannedRun::Work() const {
  double work = 0;
  for (int s = 0; s < static_cast<int>(plan_->stages().size()); ++s) {
    int iterations = 0;
    for (const Pass& pass : plan_->stages()[s].spec.passes)
      iterations += pass.num_iterations;
    for (int p = 0; p < static_cast<int>(problems_.size()); ++p) {
      if (!plan_->IsNeeded(s, p)) continue;
      const Camera camera = plan_->CameraOf(s, problems_[p].ref_image);
      work += static_cast<double>(iterations) * camera.width * camera.height;
    }
  }
  return work;
}

}  // namespace hpm
