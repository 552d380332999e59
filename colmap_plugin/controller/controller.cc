#include "colmap_plugin/controller/controller.h"

#include "colmap_plugin/controller/cut_maps.h"
#include "colmap_plugin/controller/deep_images.h"
#include "colmap_plugin/controller/engine_problems.h"
#include "colmap_plugin/controller/file_map_store.h"
#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/controller/run_budget.h"
#include "colmap_plugin/controller/run_resources.h"
#include "colmap_plugin/controller/run_setup.h"
#include "colmap_plugin/controller/run_share.h"
#include "colmap_plugin/controller/run_statistics.h"
#include "colmap_plugin/controller/run_warnings.h"
#include "colmap_plugin/controller/share_checks.h"
#include "colmap_plugin/controller/thread_supply.h"
#include "colmap_plugin/controller/unreadable_images.h"
#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/options/method_options.h"
#include "colmap_plugin/workspace/far_origin.h"
#include "colmap_plugin/workspace/image_files.h"
#include "colmap_plugin/workspace/model_overview.h"
#include "colmap_plugin/workspace/output_check.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "colmap_plugin/workspace/run_record.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/base/retries.h"
#include "src/engine/run_schedule.h"

#include <algorithm>
#include <chrono>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

// Problems of images that are only sources and have something to do.
int CountNeededSources(const std::vector<StereoProblem>& problems,
                       const StagePlan& plan) {
  int count = 0;
  for (int p = 0; p < static_cast<int>(problems.size()); ++p) {
    if (problems[p].is_reference) continue;
    bool needed = false;
    for (int s = 0; s < static_cast<int>(plan.stages().size()); ++s)
      needed |= plan.IsNeeded(s, p);
    count += needed;
  }
  return count;
}

// Users choose it for speed, and wonder about the result.
std::string WithoutGeometryNote(const Method& method) {
  return fmt::format(
      "--PatchMatchStereo.geom_consistency 0: depths are not made to agree "
      "between images{}; expect a less dense result with many more gross "
      "errors",
      method.priors == Priors::kRegions
          ? ", and surfaces with little texture get no priors"
          : "");
}

// What a user would not expect of the run that follows.
void AnnouncePlan(const std::vector<StereoProblem>& problems,
                  const StagePlan& plan,
                  const ControllerOptions& options,
                  const LogSink& log) {
  if (!plan.damaged_maps().empty()) {
    log(LogLevel::kWarning,
        fmt::format("{} maps are damaged or were changed by others, and are "
                    "computed anew, the first: {}",
                    plan.damaged_maps().size(),
                    plan.damaged_maps().begin()->string()));
  }
  const int num_sources = CountNeededSources(problems, plan);
  if (num_sources > 0) {
    log(LogLevel::kInfo,
        fmt::format("{} further images are estimated, because they are sources "
                    "of these; their maps are not published",
                    num_sources));
  }

  if (!options.patch_match.geom_consistency) {
    log(LogLevel::kWarning,
        WithoutGeometryNote(FindMethod(options.hpm.method)));
  }
}

// From now on a map is finished only if this run made it.
void ForgetMaps(const Workspace& workspace,
                const std::vector<StereoProblem>& problems,
                const StagePlan& plan) {
  for (int s = 0; s < static_cast<int>(plan.stages().size()); ++s) {
    for (const StereoProblem& problem : problems) {
      RemoveStamp(workspace.StatePath(),
                  workspace.ImageName(problem.ref_image),
                  plan.NameOf(s, problem.ref_image));
    }
  }
  // Those of images that become problems when the run is planned anew, too.
  RemoveInnerMaps(workspace);
}

int CountFinalMaps(const Workspace& workspace, const StagePlan& plan) {
  const std::string& stage = plan.stages().back().name;
  int count = 0;
  for (int image = 0; image < workspace.num_images(); ++image) {
    std::error_code ignored;
    count += std::filesystem::exists(
        workspace.MapPath(image, MapKind::kDepth, stage), ignored);
  }
  return count;
}

}  // namespace

PatchMatchController::PatchMatchController(const ControllerOptions& options,
                                           LogSink log,
                                           ProgressSink progress,
                                           const CancelToken& cancel)
    : options_(options),
      log_([this, log = std::move(log)](LogLevel level,
                                        const std::string& message) {
        if (level == LogLevel::kWarning) {
          const std::lock_guard<std::mutex> lock(mutex_);
          warnings_.push_back(message);
        }
        log(level, message);
      }),
      progress_(std::move(progress)),
      cancel_(cancel) {}

// A run on its way, for its steps.
struct PatchMatchController::RunState {
  Workspace& workspace;
  const ModelOverview& overview;
  const CancelToken& stop;
  const RunLock& lock;
  const RunShare& share;
  const ImageContents& contents;
  const Schedule& schedule;
  const RunResources& resources;
  std::vector<StereoProblem>& problems;
  StagePlan& plan;
  RunStatistics& statistics;
  const double planning_seconds;
};

RunSummary PatchMatchController::Run() {
  const auto seconds = [start = std::chrono::steady_clock::now()]() -> double {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() -
                                         start)
        .count();
  };
  const ThreadSupply threads(options_.patch_match.num_threads, log_);
  const CpuTarget target = FindCpuTarget(options_.hpm.cpu_target);

  const RetryScope retries(log_, &cancel_);
  const RunShare share(options_.hpm);

  log_(LogLevel::kInfo, "Reading workspace...");
  Workspace workspace(options_.workspace, log_, cancel_);
  CancelToken stop(&cancel_);
  const RunLock lock(workspace.StatePath(),
                     log_,
                     &stop,
                     {share.shard().index, share.shard().count});
  RemoveStaleTemporaries(workspace.StereoPath());
  ImageContents contents(workspace);
  for (const std::string& line : DropUnreadable(&workspace, &contents, stop))
    log_(LogLevel::kWarning, line);
  if (share.IsWhole()) ForgetMended(workspace, contents);
  workspace.StretchDeepImages(FindDeepRange(workspace, &contents, log_, stop));

  log_(LogLevel::kInfo, "Reading configuration...");
  const ModelOverview overview(workspace, options_.problems, stop);
  std::vector<StereoProblem> problems =
      ReadProblems(workspace, overview, options_.problems, log_, stop);
  log_(LogLevel::kInfo,
       fmt::format("Configuration has {} problems...", problems.size()));
  WarnOfFarOrigin(workspace, problems, log_);
  CompleteProblems(workspace, overview, options_, log_, stop, &problems);

  SetLevels(workspace, &options_);
  const Schedule schedule = MakeSchedule(MakeScheduleOptions(options_));
  StagePlan plan(workspace, problems, schedule, options_, &contents, stop);
  CheckShare(share, plan);
  PrepareOutputs(workspace, problems, BytesToWrite(problems, plan), log_);
  AnnouncePlan(problems, plan, options_, log_);
  const RunResources resources = OpenResources(
      workspace, problems, options_, target, threads.num_threads(), log_);
  if (options_.hpm.overwrite) {
    lock.ThrowIfLost();
    ForgetMaps(workspace, problems, plan);
  }

  RunStatistics statistics;
  const RunState run = {workspace,
                        overview,
                        stop,
                        lock,
                        share,
                        contents,
                        schedule,
                        resources,
                        problems,
                        plan,
                        statistics,
                        seconds()};
  while (!ComputeStages(run)) {
  }
  lock.ThrowIfLost();
  WarnOfChangedImages(workspace, problems, contents, log_);
  // Other shards may still need them.
  if (share.IsWhole() || share.Finishes()) {
    // In this order: a cut that is cut short is made good from the inner maps.
    if (!statistics.AnyFailed())
      CutInputMaps(workspace, problems, plan, lock, stop);
    RemoveInnerMaps(workspace);
  }
  return Summarize(run, seconds());
}

bool PatchMatchController::ComputeStages(const RunState& run) const {
  for (size_t p = 0; p < run.problems.size(); ++p) {
    const StereoProblem& problem = run.problems[p];
    if (!problem.is_reference || !run.plan.IsMine(static_cast<int>(p)))
      continue;
    // What is wrong was said when it was found.
    if (!CanBeComputed(run.workspace, problem)) {
      run.statistics.AddFailure(run.workspace.ImageName(problem.ref_image),
                                true);
    }
  }
  FileMapStore maps(run.workspace,
                    run.problems,
                    options_,
                    run.plan,
                    run.lock,
                    run.resources.inputs.get(),
                    &run.statistics,
                    log_);
  const RunSpec spec = {
      run.schedule,
      MakeMethodParams(options_),
      MakeMapFilter(options_),
      EngineProblems(run.workspace, run.problems, options_.random_seed)};
  try {
    RunSchedule(spec,
                run.resources.inputs.get(),
                &maps,
                run.resources.workers.get(),
                Events(run));
    return true;
  } catch (const UnreadableImages& error) {
    // Planned anew without them, so that all maps are those of a run that knew
    // them from the start; what is made already and needs none stays.
    run.lock.ThrowIfLost();
    for (const auto& [image, reason] : error.reasons()) {
      log_(LogLevel::kWarning, reason);
      RecordUnreadable(run.workspace, run.contents, image, reason);
      run.workspace.DropPicture(image);
    }
    // The references are the same: those that cannot be computed stay as
    // problems.
    run.problems = ReadProblems(
        run.workspace, run.overview, options_.problems, nullptr, run.stop);
    CompleteProblems(
        run.workspace, run.overview, options_, log_, run.stop, &run.problems);
    run.plan.Update();
    return false;
  } catch (const Error& error) {
    if (error.code() == ErrorCode::kInterrupted) run.lock.ThrowIfLost();
    throw;
  }
}

RunSummary PatchMatchController::Summarize(const RunState& run,
                                           double seconds) const {
  for (const std::string& line :
       FilterWarnings(run.statistics.losses(), options_)) {
    log_(LogLevel::kWarning, line);
  }
  if (run.share.IsWhole() || run.share.Finishes())
    WarnOfOldMaps(run.workspace, run.problems, run.plan, log_);
  WarnOfEmptyMaps(run.statistics.valid_shares(), run.statistics.losses(), log_);
  std::vector<std::string> names;
  for (size_t p = 0; p < run.problems.size(); ++p) {
    const StereoProblem& problem = run.problems[p];
    if (problem.is_reference && run.plan.IsMine(static_cast<int>(p)))
      names.push_back(run.workspace.ImageName(problem.ref_image));
  }
  RunSummary summary =
      run.statistics.Summarize(names, run.resources.backend_name, seconds);
  summary.planning_seconds = run.planning_seconds;
  summary.inputs_read = run.resources.inputs->counts();
  summary.warnings = warnings_;
  summary.num_fusable = CountFinalMaps(run.workspace, run.plan);
  const auto& problems = run.problems;
  const auto num_references =
      std::count_if(problems.begin(), problems.end(), [](const auto& p) {
        return p.is_reference;
      });
  // Maps of other runs may share tracks.
  summary.fusion_finds_nothing =
      summary.num_fusable <= num_references &&
      std::none_of(problems.begin(), problems.end(), [](const auto& p) {
        return p.is_reference && p.shares_points;
      });
  if (run.statistics.AnyComputed() || run.statistics.AnyFailed()) {
    // What it says is not of the maps any more.
    std::error_code ignored;
    if (!run.share.IsWhole())
      std::filesystem::remove(run.workspace.StatePath() / "run.json", ignored);
    WriteRunRecord(run.workspace.StatePath(),
                   run.share.RecordName(),
                   run.statistics.Record(options_, summary));
  }
  return summary;
}

RunEvents PatchMatchController::Events(const RunState& run) const {
  const auto name_of = [&](int problem) -> const std::string& {
    return run.workspace.ImageName(run.problems[problem].ref_image);
  };
  RunEvents events;
  events.cancel = &run.stop;
  events.started = [&, name_of](const RunProgress& at) {
    log_(LogLevel::kInfo,
         fmt::format("Processing view {} / {} for {} ({})",
                     at.number,
                     at.num_problems,
                     name_of(at.problem),
                     run.plan.stages()[at.stage].title));
  };
  events.progress = [&, name_of](const RunProgress& at) {
    if (run.plan.num_open() == 0) return;  // stages without work, one by one
    progress_({run.plan.stages()[at.stage].name,
               at.problem < 0 ? "" : name_of(at.problem),
               at.number,
               at.num_problems,
               at.fraction,
               run.plan.stages()[at.stage].title});
  };
  events.failed = [&, name_of](int, int problem, const Error& error) {
    // Images that are only sources fail by themselves: whoever reads their maps
    // goes on without.
    const bool is_reference = run.problems[problem].is_reference;
    log_(is_reference ? LogLevel::kError : LogLevel::kWarning, error.what());
    run.statistics.AddFailure(name_of(problem), is_reference);
  };
  return events;
}

}  // namespace hpm
