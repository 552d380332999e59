#include "colmap_plugin/inspect/sample_run.h"

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "src/base/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <random>
#include <system_error>
#include <vector>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

constexpr int kFirstSide = 160;  // pixels
// Of the time that is left, so that the second run ends before it is over.
constexpr double kShareToUse = 0.8;

// A folder that goes away with this object.
class ScratchWorkspace {
 public:
  // With the images and the model of another workspace, by links.
  explicit ScratchWorkspace(const fs::path& workspace) {
    std::error_code error;
    const fs::path temporary = fs::temp_directory_path(error);
    std::random_device random;
    const fs::path path =
        temporary / fmt::format("hpm_mvs_plan_{:08x}", random());
    if (!fs::create_directory(path, error) || error) return;
    path_ = path;
    fs::permissions(path_, fs::perms::owner_all, error);
    for (const char* folder : {"images", "sparse"}) {
      fs::create_directory_symlink(
          fs::absolute(workspace / folder, error), path_ / folder, error);
    }
  }
  ~ScratchWorkspace() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove_all(path_, ignored);
  }
  ScratchWorkspace(const ScratchWorkspace&) = delete;
  ScratchWorkspace& operator=(const ScratchWorkspace&) = delete;

  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// The reference with the median number of sources; -1 if none can be computed.
int TypicalProblem(const PlannedRun& run) {
  std::vector<int> problems;
  for (int p = 0; p < run.num_references(); ++p) {
    if (CanBeComputed(run.workspace(), run.problems()[p]))
      problems.push_back(p);
  }
  if (problems.empty()) return -1;
  const auto middle = problems.begin() + problems.size() / 2;
  std::nth_element(problems.begin(), middle, problems.end(), [&](int a, int b) {
    const size_t in_a = run.problems()[a].src_images.size();
    const size_t in_b = run.problems()[b].src_images.size();
    return in_a != in_b ? in_a < in_b : a < b;
  });
  return *middle;
}

void WriteCfg(const PlannedRun& run, int problem, const fs::path& path) {
  const StereoProblem& p = run.problems()[problem];
  PatchMatchCfgEntry entry;
  entry.ref_name = run.workspace().ImageName(p.ref_image);
  entry.sources = PatchMatchCfgEntry::Sources::kList;
  for (const int src : p.src_images)
    entry.src_names.push_back(run.workspace().ImageName(src));
  WritePatchMatchCfg(path, {entry});
}

}  // namespace

std::optional<Sample> MeasureSample(const PlannedRun& run,
                                    double seconds,
                                    const CancelToken& cancel) {
  const int problem = TypicalProblem(run);
  if (problem < 0) return std::nullopt;
  const int ref_image = run.problems()[problem].ref_image;
  const Camera& camera = run.workspace().camera(ref_image);
  const int full_side = std::max(camera.width, camera.height);
  const ScratchWorkspace scratch(run.options().workspace.path);
  if (scratch.path().empty()) return std::nullopt;
  ControllerOptions options = run.options();
  options.workspace.path = scratch.path();
  options.problems.config_path = scratch.path() / "sample.cfg";
  options.hpm.overwrite = true;
  options.hpm.shard = HpmOptions().shard;
  options.hpm.stage = HpmOptions().stage;
  options.hpm.previews = false;
  options.hpm.num_levels = -1;
  using Clock = std::chrono::steady_clock;
  std::optional<Clock::time_point> start;  // of the computing of a round
  double spent = 0;                        // by the rounds before
  const LogSink silent = [](LogLevel, const std::string&) {};
  CancelToken stop(&cancel);
  // A second run far slower than the first let expect is not waited for.
  const ProgressSink watch = [&](const ProgressEvent&) {
    if (!start) start = Clock::now();
    const std::chrono::duration<double> here = Clock::now() - *start;
    if (spent + here.count() > 2 * seconds) stop.Cancel();
  };
  std::optional<Sample> sample;
  int side = std::min(kFirstSide, full_side);
  try {
    WriteCfg(run, problem, options.problems.config_path);
    for (int round = 0; round < 2; ++round) {
      options.workspace.max_image_size = side;
      PlannedRun planned(options, silent, stop);
      planned.Plan(/*look_at_maps=*/false, silent);
      start.reset();
      const RunSummary summary =
          PatchMatchController(options, silent, watch, stop).Run();
      const double taken =
          std::max(summary.seconds - summary.planning_seconds, 1e-3);
      spent += taken;
      sample = Sample{planned.Work() / taken,
                      taken,
                      run.workspace().ImageName(ref_image),
                      side};
      const double growth = std::sqrt(kShareToUse * (seconds - spent) / taken);
      if (side == full_side || !(growth > 1.2)) break;
      side = std::min(full_side, static_cast<int>(side * growth));
    }
  } catch (const Error&) {
    // What is wrong with the workspace was said before; else the first round's
    // result has to do.
    cancel.ThrowIfCancelled();
  }
  return sample;
}

}  // namespace hpm
