#include "colmap_plugin/inspect/plan_run.h"

#include "colmap_plugin/controller/run_budget.h"
#include "colmap_plugin/controller/run_resources.h"
#include "colmap_plugin/controller/share_checks.h"
#include "colmap_plugin/controller/thread_supply.h"
#include "colmap_plugin/inspect/planned_run.h"
#include "colmap_plugin/workspace/far_origin.h"
#include "colmap_plugin/workspace/output_check.h"
#include "colmap_plugin/workspace/run_lock.h"
#include "src/cpu/cpu_target.h"
#include "src/engine/memory_plan.h"

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <utility>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

std::string Size(uint64_t bytes) {
  if (bytes < 1 << 30) return fmt::format("{} MB", bytes >> 20);
  return fmt::format("{:.1f} GiB", static_cast<double>(bytes) / (1 << 30));
}

std::string Duration(double seconds) {
  if (seconds < 90) return fmt::format("{:.0f} s", seconds);
  if (seconds < 90 * 60) return fmt::format("{:.0f} min", seconds / 60);
  return fmt::format("{:.1f} h", seconds / 3600);
}

bool Contains(const std::vector<std::string>& lines, const std::string& line) {
  return std::find(lines.begin(), lines.end(), line) != lines.end();
}

class Planner {
 public:
  Planner(const ControllerOptions& options,
          double sample_seconds,
          const LogSink& log,
          const CancelToken& cancel)
      : options_(options),
        sample_seconds_(sample_seconds),
        log_(log),
        cancel_(cancel) {}

  RunPlan Run() {
    std::optional<ThreadSupply> threads;
    Attempt([&] { threads.emplace(options_.patch_match.num_threads, log_); });
    std::optional<CpuTarget> target;
    Attempt([&] { target = FindCpuTarget(options_.hpm.cpu_target); });
    const auto start = std::chrono::steady_clock::now();
    if (!ReadAndPlan()) return std::move(plan_);
    planning_seconds_ =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start)
            .count();
    WarnOfFarOrigin(run_->workspace(), run_->problems(), log_);
    SayImages();
    SaySizes();
    SayDisk();
    Attempt([&] { CheckFirstInputs(); });
    if (threads && target) SayMemory(*target, threads->num_threads());
    // Of what can be computed.
    if (plan_.exit_code == 0 ||
        plan_.exit_code == static_cast<int>(ErrorCode::kPartial))
      SayTime();
    return std::move(plan_);
  }

 private:
  bool Attempt(const std::function<void()>& action) {
    try {
      action();
      return true;
    } catch (const Error& error) {
      if (error.code() == ErrorCode::kInterrupted) throw;
      if (!Contains(plan_.problems, error.what()))
        plan_.problems.push_back(error.what());
      if (plan_.exit_code == 0)
        plan_.exit_code = static_cast<int>(error.code());
      return false;
    }
  }

  template <class... T>
  void Say(fmt::format_string<T...> format, T&&... values) {
    plan_.lines.push_back(fmt::format(format, std::forward<T>(values)...));
  }

  // Where a file that an option names may be at fault, goes on without it, to
  // find what else is wrong.
  bool ReadAndPlan() {
    ControllerOptions options = options_;
    std::set<std::string> said;
    const LogSink once = [&](LogLevel level, const std::string& line) {
      if (said.insert(line).second) log_(level, line);
    };
    if (Attempt([&] { ReadAndPlanWith(options, once); })) return true;
    for (fs::path* file :
         {&options.workspace.mask_path, &options.problems.depth_ranges}) {
      if (file->empty()) continue;
      file->clear();
      if (Attempt([&] { ReadAndPlanWith(options, once); })) return true;
    }
    return false;
  }

  void ReadAndPlanWith(const ControllerOptions& options, const LogSink& log) {
    run_.reset();  // two models would be twice the memory
    run_ = std::make_unique<PlannedRun>(options, log, cancel_);
    const RunShare share(options.hpm);
    Attempt([&] {
      ThrowIfLocked(run_->workspace().StatePath(),
                    {share.shard().index, share.shard().count});
    });
    run_->DropTruncatedImages(log);
    run_->Plan(/*look_at_maps=*/true, log);
    CheckShare(share, run_->plan());
  }

  // Of the stage that this process would begin with.
  void CheckFirstInputs() const {
    const StagePlan& plan = run_->plan();
    for (int s = 0; s < static_cast<int>(plan.stages().size()); ++s) {
      for (int p = 0; p < static_cast<int>(run_->problems().size()); ++p) {
        if (plan.IsNeeded(s, p))
          return CheckInputs(RunShare(options_.hpm), plan, s);
      }
    }
  }

  void SayImages() {
    const std::vector<StereoProblem>& problems = run_->problems();
    const int num_references = run_->num_references();
    const int last = static_cast<int>(run_->plan().stages().size()) - 1;
    std::vector<size_t> sources;
    std::vector<std::string> failing;
    int num_kept = 0;
    int num_mine = 0;
    for (int p = 0; p < num_references; ++p) {
      if (!run_->plan().IsMine(p)) continue;
      ++num_mine;
      sources.push_back(problems[p].src_images.size());
      if (!CanBeComputed(run_->workspace(), problems[p])) {
        failing.push_back(run_->workspace().ImageName(problems[p].ref_image));
        continue;
      }
      bool is_needed = false;
      for (int s = 0; s <= last; ++s) is_needed |= run_->plan().IsNeeded(s, p);
      num_kept += !is_needed;
    }
    std::sort(sources.begin(), sources.end());
    Say("Images: {} to compute, {} kept from an earlier run, {} cannot be "
        "computed",
        num_mine - num_kept - static_cast<int>(failing.size()),
        num_kept,
        failing.size());
    if (num_mine < num_references)
      Say("Images of other shards: {}", num_references - num_mine);
    if (problems.size() > static_cast<size_t>(num_references)) {
      Say("Further images, as they are sources of these: {}",
          problems.size() - num_references);
    }
    if (!sources.empty()) {
      Say("Sources per image: {} to {}, median {}",
          sources.front(),
          sources.back(),
          sources[sources.size() / 2]);
    }
    if (failing.empty()) return;
    plan_.problems.push_back(fmt::format(
        "{} of {} images would fail, the first: {}; the others would be "
        "computed",
        failing.size(),
        num_mine,
        failing.front()));
    if (plan_.exit_code == 0)
      plan_.exit_code = static_cast<int>(ErrorCode::kPartial);
  }

  void SaySizes() {
    std::map<std::pair<int, int>, int> sizes;
    for (int p = 0; p < run_->num_references(); ++p) {
      const Camera& camera =
          run_->workspace().camera(run_->problems()[p].ref_image);
      ++sizes[{camera.width, camera.height}];
    }
    const auto most = std::max_element(
        sizes.begin(), sizes.end(), [](const auto& a, const auto& b) {
          return a.second < b.second;
        });
    Say("Working size: {}x{}{}; {} levels, {} stages",
        most->first.first,
        most->first.second,
        sizes.size() > 1 ? fmt::format(" of {} images, {} other sizes",
                                       most->second,
                                       sizes.size() - 1)
                         : "",
        run_->options().hpm.num_levels,
        run_->plan().stages().size());
  }

  void SayDisk() {
    const uint64_t bytes = BytesToWrite(run_->problems(), run_->plan());
    Attempt([&] {
      CheckOutputs(
          run_->workspace(), run_->problems(), bytes, OutputAccess::kInspect);
    });
    const std::optional<uint64_t> num_free =
        FreeBytes(run_->workspace().StatePath());
    Say("Disk: {} to write{}",
        Size(bytes),
        num_free ? ", " + Size(*num_free) + " free" : "");
  }

  // What the run says of it itself.
  void SayMemory(const CpuTarget& target, int num_threads) {
    const LogSink say = [this](LogLevel level, const std::string& line) {
      if (level == LogLevel::kInfo) {
        plan_.lines.push_back("Computed on: " + line);
      } else {
        log_(level, line);
      }
    };
    Attempt([&] {
      OpenResources(run_->workspace(),
                    run_->problems(),
                    run_->options(),
                    target,
                    num_threads,
                    say);
    });
    Say("Memory that may be used: {}", Size(MemoryLimit()));
  }

  void SayTime() {
    const double work = run_->Work();
    if (work == 0) {
      Say("Time: nothing is left to compute");
      return;
    }
    if (sample_seconds_ <= 0) return;
    log_(LogLevel::kInfo,
         fmt::format("Measuring how fast this machine is, about {}...",
                     Duration(sample_seconds_)));
    const std::optional<Sample> sample =
        MeasureSample(*run_, sample_seconds_, cancel_);
    if (!sample) {
      Say("Time: could not be measured");
      return;
    }
    plan_.lines.push_back(TimeLine(work, planning_seconds_, *sample));
  }

  const ControllerOptions& options_;
  const double sample_seconds_;
  const LogSink& log_;
  const CancelToken& cancel_;
  std::unique_ptr<PlannedRun> run_;
  double planning_seconds_ = 0;  // about as long as the run plans
  RunPlan plan_;
};

}  // namespace

std::string TimeLine(double work,
                     double planning_seconds,
                     const Sample& sample) {
  return fmt::format(
      "Time: about {}, from {:.1f} s of {} at {} pixels; {:.1f} s of it to "
      "read and plan",
      Duration(planning_seconds + work / sample.work_per_second),
      sample.seconds,
      sample.image,
      sample.max_image_size,
      planning_seconds);
}

RunPlan PlanRun(const ControllerOptions& options,
                double sample_seconds,
                const LogSink& log,
                const CancelToken& cancel) {
  return Planner(options, sample_seconds, log, cancel).Run();
}

}  // namespace hpm
