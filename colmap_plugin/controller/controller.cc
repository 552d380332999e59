#include "colmap_plugin/controller/controller.h"

#include "colmap_plugin/controller/cut_maps.h"
#include "colmap_plugin/controller/deep_images.h"
#include "colmap_plugin/controller/devices.h"
#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/controller/run_budget.h"
#include "colmap_plugin/controller/run_statistics.h"
#include "colmap_plugin/controller/stage_runner.h"
#include "colmap_plugin/controller/thread_supply.h"
#include "colmap_plugin/controller/worker_pool.h"
#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/options/method_options.h"
#include "colmap_plugin/workspace/far_origin.h"
#include "colmap_plugin/workspace/image_files.h"
#include "colmap_plugin/workspace/output_check.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "colmap_plugin/workspace/run_record.h"
#include "colmap_plugin/workspace/source_problems.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_plan.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <mutex>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace {

// The largest image of the workspace decides for all, so that all have the same
// stages, whichever of them this run computes.
int LevelsOf(const Method& method, const Workspace& workspace) {
  int side = 1;
  for (int image = 0; image < workspace.num_images(); ++image) {
    if (!workspace.usable(image)) continue;
    const Camera& camera = workspace.camera(image);
    side = std::max({side, camera.width, camera.height});
  }
  return AutomaticLevels(method, side);
}

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

// Work of a stage of an image: iterations times pixels.
double WorkOf(const StagePlan& plan, int stage, const StereoProblem& problem) {
  const Camera camera = plan.CameraOf(stage, problem.ref_image);
  int iterations = 0;
  for (const Pass& pass : plan.stages()[stage].spec.passes) {
    iterations += pass.num_iterations;
  }
  return static_cast<double>(iterations) * camera.width * camera.height;
}

// Behind the references, which come first.
void AddSourceProblems(const Workspace& workspace,
                       const ProblemOptions& options,
                       std::vector<StereoProblem>* problems) {
  for (StereoProblem& problem : SourceProblems(workspace, *problems, options))
    problems->push_back(std::move(problem));
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

// What came from such images is stamped as incomplete.
void WarnOfChangedImages(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const ImageContents& contents,
                         const LogSink& log) {
  std::set<int> images;
  for (const StereoProblem& problem : problems) {
    if (!CanBeComputed(workspace, problem)) continue;
    images.insert(problem.ref_image);
    images.insert(problem.src_images.begin(), problem.src_images.end());
  }
  ImageFault changed;
  for (const int image : images) {
    if (!contents.IsUnchanged(image))
      changed.Add(workspace.ImagePath(image).string());
  }
  if (changed.num() == 0) return;
  log(LogLevel::kWarning,
      changed.Line(static_cast<int>(problems.size()),
                   "changed during this run") +
          "; run again, which makes anew what was made from them");
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
      log_(std::move(log)),
      progress_(std::move(progress)),
      cancel_(cancel) {}

RunSummary PatchMatchController::Run() {
  const auto start = std::chrono::steady_clock::now();
  const ThreadSupply threads(options_.patch_match.num_threads, log_);
  const int num_threads = threads.num_threads();
  const CpuTarget target = FindCpuTarget(options_.hpm.cpu_target);
  std::vector<std::unique_ptr<Backend>> cpus;
  cpus.push_back(MakeCpuBackend(target, num_threads));

  log_(LogLevel::kInfo, "Reading workspace...");
  Workspace workspace(options_.workspace, log_);
  CancelToken stop(&cancel_);
  const RunLock lock(workspace.StatePath(), log_, &stop);
  RemoveStaleTemporaries(workspace.StereoPath());
  ImageContents contents(workspace);
  workspace.StretchDeepImages(FindDeepRange(workspace, &contents, log_, stop));

  log_(LogLevel::kInfo, "Reading configuration...");
  const ProblemOptions& problem_options = options_.problems;
  std::vector<StereoProblem> problems =
      ReadProblems(workspace, problem_options, log_);
  const size_t num_references = problems.size();
  log_(LogLevel::kInfo,
       fmt::format("Configuration has {} problems...", num_references));
  WarnOfFarOrigin(workspace, problems, log_);

  const bool geometric = options_.patch_match.geom_consistency;
  if (geometric) AddSourceProblems(workspace, problem_options, &problems);
  if (options_.hpm.num_levels <= 0) {
    options_.hpm.num_levels =
        LevelsOf(FindMethod(options_.hpm.method), workspace);
  }
  const Schedule schedule = MakeSchedule(MakeScheduleOptions(options_));
  StagePlan plan(workspace, problems, schedule, options_, &contents, stop);
  PrepareOutputs(workspace, problems, BytesToWrite(problems, plan), log_);
  if (!plan.damaged_maps().empty()) {
    log_(LogLevel::kWarning,
         fmt::format("{} maps are damaged or were changed by others, and are "
                     "computed anew, the first: {}",
                     plan.damaged_maps().size(),
                     plan.damaged_maps().begin()->string()));
  }
  const int num_sources = CountNeededSources(problems, plan);
  if (num_sources > 0) {
    log_(
        LogLevel::kInfo,
        fmt::format("{} further images are estimated, because they are sources "
                    "of these; their maps are not published",
                    num_sources));
  }

  if (!geometric) {
    log_(LogLevel::kWarning,
         WithoutGeometryNote(FindMethod(options_.hpm.method)));
  }
  std::vector<std::unique_ptr<Backend>> gpus =
      OpenGpus(options_,
               LargestProblem(workspace, problems, geometric),
               static_cast<int>(problems.size()),
               num_threads,
               RealGpus(),
               log_);
  const Backend& first = gpus.empty() ? *cpus.front() : *gpus.front();
  MemoryNeeds needs = LargestNeeds(workspace, problems, first, geometric);
  if (gpus.size() > 1) {
    gpus.resize(
        ImagesInMemory(needs, static_cast<int>(gpus.size()), MemoryLimit()));
  } else if (gpus.empty() &&
             CpuImagesInFlight(needs, num_threads, MemoryLimit()) > 1) {
    cpus.push_back(MakeCpuBackend(target, num_threads));
  }
  const int num_decodes = DecodesAtOnce(needs);
  const size_t num_in_flight = std::max(cpus.size(), gpus.size());
  needs.working *= num_in_flight;
  needs.inputs *= num_in_flight;
  const std::string backend_name = first.Name();
  InputCache inputs(workspace,
                    PlanCacheBytes(CacheBytes(options_.patch_match.cache_size),
                                   needs.working,
                                   needs.inputs,
                                   MemoryLimit()),
                    num_decodes);
  log_(LogLevel::kInfo,
       fmt::format("{}{}, method {}, about {} MB of memory",
                   backend_name,
                   num_in_flight > 1
                       ? fmt::format(", {} images in flight", num_in_flight)
                       : "",
                   options_.hpm.method,
                   (needs.working + needs.inputs) >> 20));

  WorkerPool workers(
      std::move(cpus),
      std::move(gpus),
      [&](Backend* backend) {
        return std::make_unique<StageRunner>(workspace,
                                             problems,
                                             schedule,
                                             options_,
                                             plan,
                                             lock,
                                             &inputs,
                                             backend,
                                             log_);
      },
      options_.hpm.device != "cuda",
      log_);
  RunStatistics statistics;
  if (options_.hpm.overwrite) {
    lock.ThrowIfLost();
    ForgetMaps(workspace, problems, plan);
  }
  for (bool is_done = false; !is_done;) {
    for (const StereoProblem& problem : problems) {
      // What is wrong was said when it was found.
      if (problem.is_reference && !CanBeComputed(workspace, problem))
        statistics.AddFailure(workspace.ImageName(problem.ref_image));
    }
    try {
      RunStages(
          workspace, problems, plan, &inputs, &workers, stop, &statistics);
      is_done = true;
    } catch (const UnreadableImage& error) {
      // Planned anew without it, so that all maps are those of a run that knew
      // it from the start; what is made already and does not need it stays.
      lock.ThrowIfLost();
      log_(LogLevel::kWarning, error.what());
      workspace.DropPicture(error.image());
      // The references are the same: those that cannot be computed stay as
      // problems.
      problems = ReadProblems(workspace, problem_options, nullptr);
      if (geometric) AddSourceProblems(workspace, problem_options, &problems);
      options_.hpm.overwrite = false;
      plan.Update();
    } catch (const Error& error) {
      if (error.code() == ErrorCode::kInterrupted) lock.ThrowIfLost();
      throw;
    }
  }
  lock.ThrowIfLost();
  WarnOfChangedImages(workspace, problems, contents, log_);
  // In this order: a cut that is cut short is made good from the inner maps.
  if (!statistics.AnyFailed())
    CutInputMaps(workspace, problems, plan, lock, stop);
  RemoveInnerMaps(workspace);

  std::vector<std::string> names;
  for (size_t p = 0; p < num_references; ++p)
    names.push_back(workspace.ImageName(problems[p].ref_image));
  for (const std::string& line :
       FilterWarnings(statistics.losses(), options_)) {
    log_(LogLevel::kWarning, line);
  }
  RunSummary summary = statistics.Summarize(
      names,
      backend_name,
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count());
  summary.num_fusable = CountFinalMaps(workspace, plan);
  if (statistics.AnyComputed() || statistics.AnyFailed()) {
    WriteRunRecord(workspace.StatePath(), statistics.Record(options_, summary));
  }
  return summary;
}

void PatchMatchController::RunStages(const Workspace& workspace,
                                     const std::vector<StereoProblem>& problems,
                                     const StagePlan& plan,
                                     InputCache* inputs,
                                     WorkerPool* workers,
                                     const CancelToken& cancel,
                                     RunStatistics* statistics) {
  const int num_stages = static_cast<int>(plan.stages().size());
  const int num_problems = static_cast<int>(problems.size());
  // Images that are only sources fail by themselves: whoever reads their maps
  // goes on without.
  std::set<int> failed_sources;
  double total_work = 0, done_work = 0;
  for (int s = 0; s < num_stages; ++s) {
    for (int p = 0; p < num_problems; ++p) {
      if (plan.IsNeeded(s, p)) total_work += WorkOf(plan, s, problems[p]);
    }
  }

  for (int s = 0; s < num_stages; ++s) {
    const Stage& stage = plan.stages()[s];
    const int num_needed = plan.CountNeeded(s);
    inputs->StartStage(stage.spec.level);
    std::vector<int> needed;
    for (int p = 0; p < num_problems; ++p) {
      if (plan.IsNeeded(s, p)) needed.push_back(p);
    }
    // Guards the statistics, the progress and what follows.
    std::mutex mutex;
    int number = 0;
    workers->Run(needed, [&](StageRunner* runner, int p) {
      cancel.ThrowIfCancelled();
      const std::string& name = workspace.ImageName(problems[p].ref_image);
      const double work = WorkOf(plan, s, problems[p]);
      double counted = 0;  // of `work`, in done_work
      ProgressEvent event = {stage.name, name, 0, num_needed, 0};
      const auto count = [&](double fraction) {
        const std::lock_guard<std::mutex> lock(mutex);
        done_work += fraction * work - counted;
        counted = fraction * work;
        event.fraction = done_work / total_work;
        if (fraction < 1) progress_(event);
      };
      bool has_failed;
      {
        const std::lock_guard<std::mutex> lock(mutex);
        event.image_number = ++number;
        has_failed = statistics->HasFailed(name) || failed_sources.count(p) > 0;
      }
      if (has_failed) return count(1);
      const bool is_reference = problems[p].is_reference;
      const std::string stage_name = plan.NameOf(s, problems[p].ref_image);
      log_(LogLevel::kInfo,
           fmt::format("Processing view {} / {} for {} ({})",
                       event.image_number,
                       num_needed,
                       name,
                       stage_name));
      RunControl control;
      control.cancel = &cancel;
      control.progress = count;
      try {
        const StageResult result = runner->Run(s, p, control);
        const std::lock_guard<std::mutex> lock(mutex);
        // Not before: an image that cannot be decoded changes the plan.
        if (!statistics->AnyWork() && plan.ReplacesForeignMaps()) {
          log_(LogLevel::kWarning,
               "maps made with other options, from other images, by another "
               "version or by another program are computed anew");
        }
        statistics->Add(name,
                        is_reference,
                        stage,
                        stage_name,
                        plan.CameraOf(s, problems[p].ref_image),
                        result);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::kBadInput ||
            dynamic_cast<const UnreadableImage*>(&error) != nullptr) {
          const std::lock_guard<std::mutex> lock(mutex);
          --number;
          done_work -= counted;
          throw;
        }
        log_(is_reference ? LogLevel::kError : LogLevel::kWarning,
             error.what());
        const std::lock_guard<std::mutex> lock(mutex);
        if (is_reference) {
          statistics->AddFailure(name);
        } else {
          failed_sources.insert(p);
        }
      }
      count(1);
    });
    progress_({stage.name,
               "",
               num_needed,
               num_needed,
               total_work > 0 ? done_work / total_work : 1});
  }
}

}  // namespace hpm
