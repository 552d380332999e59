#include "colmap_plugin/controller/controller.h"

#include "colmap_plugin/controller/method_options.h"
#include "colmap_plugin/controller/stage_runner.h"
#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/workspace/output_check.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "colmap_plugin/workspace/run_record.h"
#include "src/base/error.h"
#include "src/cpu/cpu_backend.h"
#include "src/engine/memory_plan.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

namespace hpm {
namespace {

uint64_t PeakMemoryBytes() {
  rusage usage = {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<uint64_t>(usage.ru_maxrss) * 1024;
}

// Largest need over all problems: working memory, and the inputs of one
// problem.
struct MemoryNeeds {
  uint64_t working = 0;
  uint64_t inputs = 0;
};

MemoryNeeds LargestNeeds(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const Backend& backend,
                         bool geometric) {
  MemoryNeeds needs;
  for (const StereoProblem& problem : problems) {
    uint64_t largest_src = 0;
    uint64_t inputs = 0;
    for (const int src : problem.src_images) {
      const uint64_t pixels =
          static_cast<uint64_t>(workspace.camera(src).width) *
          workspace.camera(src).height;
      largest_src = std::max(largest_src, pixels);
      inputs += pixels * (geometric ? 1 + sizeof(float) : 1);
    }
    const Camera& ref = workspace.camera(problem.ref_image);
    const uint64_t ref_pixels = static_cast<uint64_t>(ref.width) * ref.height;
    const int num_srcs = static_cast<int>(problem.src_images.size());
    // The maps being written stand beside the state: depth, normals.
    const uint64_t working =
        backend.MemoryNeeded(ref.width, ref.height, num_srcs, geometric) +
        ref_pixels * 4 * sizeof(float);
    needs.working = std::max(needs.working, working);
    needs.inputs = std::max(needs.inputs, inputs + ref_pixels);
  }
  return needs;
}

uint64_t CacheBytes(double gibibytes) {
  constexpr double kMaxGibibytes = 1 << 20;
  return static_cast<uint64_t>(std::min(gibibytes, kMaxGibibytes) *
                               (1ull << 30));
}

uint64_t BytesToWrite(const Workspace& workspace,
                      const std::vector<StereoProblem>& problems,
                      const StagePlan& plan) {
  uint64_t bytes = 0;
  for (size_t s = 0; s < plan.stages().size(); ++s) {
    for (size_t p = 0; p < problems.size(); ++p) {
      if (plan.IsNeeded(static_cast<int>(s), static_cast<int>(p))) {
        bytes +=
            DepthAndNormalMapBytes(workspace.camera(problems[p].ref_image));
      }
    }
  }
  return bytes;
}

// Maps between geometric passes are of no use once the result is complete.
void RemoveInnerMaps(const Workspace& workspace, const StagePlan& plan) {
  std::error_code ignored;
  for (size_t s = 1; s + 1 < plan.stages().size(); ++s) {
    std::filesystem::remove_all(workspace.StatePath() / plan.stages()[s].name,
                                ignored);
  }
}

nlohmann::json OptionsRecord(const ControllerOptions& options) {
  const PatchMatchStereoOptions& colmap = options.patch_match;
  return {{"method", options.hpm.method},
          {"random_seed", options.random_seed},
          {"num_iterations", options.hpm.num_iterations},
          {"num_geom_iterations", options.hpm.num_geom_iterations},
          {"num_geom_passes", options.hpm.num_geom_passes},
          {"geom_consistency", colmap.geom_consistency},
          {"max_image_size", options.workspace.max_image_size},
          {"window_radius", colmap.window_radius},
          {"filter", colmap.filter}};
}

}  // namespace

PatchMatchController::PatchMatchController(const ControllerOptions& options,
                                           LogSink log,
                                           ProgressSink progress,
                                           const CancelToken& cancel)
    : options_(options),
      log_(std::move(log)),
      progress_(std::move(progress)),
      cancel_(cancel) {
  options_.workspace.max_image_size = options_.patch_match.max_image_size;
}

RunSummary PatchMatchController::Run() {
  const auto start = std::chrono::steady_clock::now();
  const std::unique_ptr<Backend> backend =
      MakeCpuBackend(options_.hpm.cpu_target, options_.patch_match.num_threads);

  log_(LogLevel::kInfo, "Reading workspace...");
  const Workspace workspace(options_.workspace, log_);
  const RunLock lock(workspace.StatePath());
  RemoveStaleTemporaries(workspace.StereoPath());

  log_(LogLevel::kInfo, "Reading configuration...");
  const PatchMatchStereoOptions& colmap = options_.patch_match;
  ProblemOptions problem_options;
  problem_options.config_path = options_.config_path;
  problem_options.depth_min = colmap.depth_min;
  problem_options.depth_max = colmap.depth_max;
  problem_options.min_triangulation_angle = colmap.min_triangulation_angle;
  const std::vector<StereoProblem> problems =
      ReadProblems(workspace, problem_options, log_);
  log_(LogLevel::kInfo,
       fmt::format("Configuration has {} problems...", problems.size()));

  const StagePlan plan(workspace, problems, options_);
  PrepareOutputs(workspace, problems, BytesToWrite(workspace, problems, plan));
  if (plan.ReplacesForeignMaps()) {
    log_(
        LogLevel::kWarning,
        "maps made with other options or by another program are computed anew");
  }

  const MemoryNeeds needs =
      LargestNeeds(workspace, problems, *backend, colmap.geom_consistency);
  const uint64_t cache_bytes = PlanCacheBytes(CacheBytes(colmap.cache_size),
                                              needs.working,
                                              needs.inputs,
                                              MemoryLimit());
  log_(LogLevel::kInfo,
       fmt::format("{}, method {}, about {} MB of memory",
                   backend->Name(),
                   options_.hpm.method,
                   (needs.working + needs.inputs) >> 20));

  InputCache inputs(workspace, cache_bytes, log_);
  StageRunner runner(
      workspace, problems, options_, plan, &inputs, backend.get(), log_);

  RunSummary summary;
  summary.num_problems = static_cast<int>(problems.size());
  summary.cpu_target = backend->Name();
  const int num_stages = static_cast<int>(plan.stages().size());
  double total_work = 0, done_work = 0;
  // Work of a stage of an image: one for each iteration of each pass, per
  // pixel.
  const auto work_of = [&](int s, int p) {
    const Camera& camera = workspace.camera(problems[p].ref_image);
    const Schedule schedule = MakeSchedule(
        MakeScheduleOptions(options_), camera.width, camera.height);
    double iterations = 0;
    if (plan.stages()[s].geometric_pass < 0) {
      for (const Pass& pass : schedule.photometric)
        iterations += pass.num_iterations;
    } else {
      iterations =
          schedule.geometric[plan.stages()[s].geometric_pass].num_iterations;
    }
    return iterations * camera.width * camera.height;
  };
  for (int s = 0; s < num_stages; ++s) {
    for (int p = 0; p < summary.num_problems; ++p) {
      if (plan.IsNeeded(s, p)) total_work += work_of(s, p);
    }
  }

  nlohmann::json images;
  std::set<int> computed;
  std::set<std::string> failed;
  PhaseTimes seconds;
  double evaluations = 0, pixels = 0, valid = 0, num_final = 0;
  for (int s = 0; s < num_stages; ++s) {
    const Stage& stage = plan.stages()[s];
    const int num_needed = plan.CountNeeded(s);
    inputs.ForgetDepths();
    int number = 0;
    for (int p = 0; p < summary.num_problems; ++p) {
      cancel_.ThrowIfCancelled();
      if (!plan.IsNeeded(s, p)) continue;
      const std::string& name = workspace.ImageName(problems[p].ref_image);
      ++number;
      if (failed.count(name) > 0) continue;
      log_(LogLevel::kInfo,
           fmt::format("Processing view {} / {} for {} ({})",
                       number,
                       num_needed,
                       name,
                       stage.name));
      ProgressEvent event = {stage.name, name, number, num_needed, 0};
      const double work = work_of(s, p);
      RunControl control;
      control.cancel = &cancel_;
      control.progress = [&](double fraction) {
        event.fraction = (done_work + fraction * work) / total_work;
        progress_(event);
      };
      try {
        const StageResult result = runner.Run(s, p, control);
        computed.insert(p);
        const Camera& camera = workspace.camera(problems[p].ref_image);
        const double size = static_cast<double>(camera.width) * camera.height;
        evaluations += result.cost_evaluations_per_pixel * size;
        if (s == 0) pixels += size;
        if (stage.is_final) {
          valid += result.valid_pixel_share;
          num_final += 1;
        }
        for (const auto& [phase, time] : result.seconds) seconds[phase] += time;
        images[name][stage.name] = ToJson(result);
      } catch (const Error& error) {
        if (error.code() != ErrorCode::kBadInput) throw;
        log_(LogLevel::kError, error.what());
        failed.insert(name);
      }
      done_work += work;
    }
    progress_({stage.name,
               "",
               num_needed,
               num_needed,
               total_work > 0 ? done_work / total_work : 1});
  }
  if (failed.empty()) RemoveInnerMaps(workspace, plan);

  if (!colmap.allow_missing_files) {
    for (const std::string& name : inputs.UnreadableImages())
      failed.insert(name);
  }
  summary.failed.assign(failed.begin(), failed.end());
  summary.num_computed = static_cast<int>(computed.size());
  summary.num_kept = summary.num_problems - summary.num_computed;
  for (const std::string& name : failed) {
    const int image = workspace.ImageIndex(name);
    for (int p = 0; p < summary.num_problems; ++p) {
      if (problems[p].ref_image == image && computed.count(p) == 0)
        --summary.num_kept;
    }
  }
  summary.valid_pixel_share = num_final > 0 ? valid / num_final : 0;
  summary.ncc_evaluations_per_pixel = pixels > 0 ? evaluations / pixels : 0;
  summary.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
          .count();
  summary.peak_memory_bytes = PeakMemoryBytes();

  if (!computed.empty() || !failed.empty()) {
    WriteRunRecord(
        workspace.StatePath(),
        {{"options", OptionsRecord(options_)},
         {"backend", backend->Name()},
         {"seconds", summary.seconds},
         {"seconds_per_phase", seconds},
         {"ncc_evaluations_per_pixel", summary.ncc_evaluations_per_pixel},
         {"valid_pixel_share", summary.valid_pixel_share},
         {"peak_memory_bytes", summary.peak_memory_bytes},
         {"images_computed", summary.num_computed},
         {"images_kept", summary.num_kept},
         {"images_failed", summary.failed},
         {"images", images}});
  }
  return summary;
}

}  // namespace hpm
