#include "colmap_plugin/inspect/run_status.h"

#include "colmap_plugin/inspect/planned_run.h"

#include <algorithm>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace hpm {
namespace {

StageStatus StatusOf(const PlannedRun& run, int stage) {
  StageStatus status;
  status.name = run.plan().stages()[stage].name;
  for (int p = 0; p < static_cast<int>(run.problems().size()); ++p) {
    if (!CanBeComputed(run.workspace(), run.problems()[p])) continue;
    switch (run.plan().StateAt(stage, p)) {
      case MapState::kNotAsked:
      case MapState::kFinished:
        ++status.num_finished;
        continue;
      case MapState::kMissing:
        break;
      case MapState::kForeign:
        ++status.num_stale;
        break;
      case MapState::kIncomplete:
        ++status.num_incomplete;
        break;
      case MapState::kDamaged:
        ++status.num_damaged;
        break;
    }
    ++status.num_needed;
  }
  return status;
}

}  // namespace

int RunStatus::num_needed() const {
  int count = 0;
  for (const StageStatus& stage : stages) count += stage.num_needed;
  return count;
}

RunStatus FindStatus(const ControllerOptions& given,
                     bool verify,
                     const LogSink& log,
                     const CancelToken& cancel) {
  ControllerOptions options = given;
  options.hpm.overwrite = false;           // what is there counts
  options.hpm.shard = HpmOptions().shard;  // of all shards and stages
  options.hpm.stage = HpmOptions().stage;
  PlannedRun run(options, log, cancel);
  run.Plan(/*look_at_maps=*/true,
           log,
           verify ? PlanAccess::kVerify : PlanAccess::kInspect);
  RunStatus status;
  for (int s = 0; s < static_cast<int>(run.plan().stages().size()); ++s)
    status.stages.push_back(StatusOf(run, s));
  for (const StereoProblem& problem : run.problems()) {
    if (problem.is_reference && !CanBeComputed(run.workspace(), problem))
      status.failing.push_back(run.workspace().ImageName(problem.ref_image));
  }
  return status;
}

std::string StatusText(const RunStatus& status) {
  size_t width = 5;
  for (const StageStatus& stage : status.stages)
    width = std::max(width, stage.name.size());
  std::string text = fmt::format("{:{}} {:>9} {:>9} {:>11} {:>9} {:>9}\n",
                                 "stage",
                                 width,
                                 "finished",
                                 "needed",
                                 "incomplete",
                                 "damaged",
                                 "stale");
  for (const StageStatus& stage : status.stages) {
    text += fmt::format("{:{}} {:>9} {:>9} {:>11} {:>9} {:>9}\n",
                        stage.name,
                        width,
                        stage.num_finished,
                        stage.num_needed,
                        stage.num_incomplete,
                        stage.num_damaged,
                        stage.num_stale);
  }
  if (!status.failing.empty()) {
    text += fmt::format(
        "{} images cannot be computed, since they or all their sources have no "
        "picture, the first: {}\n",
        status.failing.size(),
        status.failing.front());
  }
  if (status.IsComplete()) return text + "complete\n";
  return text + (status.num_needed() > 0
                     ? "not complete: run patch_match_stereo with the same "
                       "options\n"
                     : "not complete, and a run has nothing to do until these "
                       "images are mended\n");
}

std::string StatusJson(const RunStatus& status) {
  nlohmann::json json = {{"complete", status.IsComplete()},
                         {"failing", status.failing},
                         {"stages", nlohmann::json::array()}};
  for (const StageStatus& stage : status.stages) {
    json["stages"].push_back({{"name", stage.name},
                              {"finished", stage.num_finished},
                              {"needed", stage.num_needed},
                              {"incomplete", stage.num_incomplete},
                              {"damaged", stage.num_damaged},
                              {"stale", stage.num_stale}});
  }
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) +
         "\n";
}

}  // namespace hpm
