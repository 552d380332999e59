#include "src/engine/run_schedule.h"

#include "src/core/limits.h"
#include "src/engine/run_stage.h"
#include "src/engine/work_estimate.h"

#include <mutex>
#include <vector>

#include <fmt/format.h>

namespace hpm {
namespace {

void CheckSpec(const RunSpec& spec) {
  const std::vector<StageSpec>& stages = spec.schedule.stages;
  // A backend without views cannot say what they confirm.
  if (spec.filter && !stages.empty() && stages.back().passes.empty()) {
    throw Error(ErrorCode::kUsage,
                "the last stage has no passes, so that nothing can be "
                "filtered; give it one, or no filter");
  }
  for (const Problem& problem : spec.problems) {
    if (problem.sources.size() <= kMaxViews) continue;
    throw Error(ErrorCode::kUsage,
                fmt::format("image {}: {} sources, at most {} can be matched",
                            problem.image,
                            problem.sources.size(),
                            kMaxViews));
  }
}

class ScheduledRun {
 public:
  ScheduledRun(const RunSpec& spec,
               ImageStore* images,
               MapStore* maps,
               WorkerPool* workers,
               const RunEvents& events)
      : spec_(spec),
        images_(images),
        maps_(maps),
        workers_(workers),
        events_(events),
        has_failed_(spec.problems.size(), false),
        needed_(spec.schedule.stages.size()) {
    for (int s = 0; s < num_stages(); ++s) {
      for (int p = 0; p < static_cast<int>(spec.problems.size()); ++p) {
        if (!maps->IsNeeded(s, p)) continue;
        needed_[s].push_back(p);
        total_work_ += WorkOf(s, p);
      }
      work_until_.push_back(total_work_);
    }
  }

  void Run() {
    for (int s = 0; s < num_stages(); ++s) RunOneStage(s);
  }

 private:
  int num_stages() const {
    return static_cast<int>(spec_.schedule.stages.size());
  }

  double WorkOf(int stage, int problem) const {
    const StageSpec& spec = spec_.schedule.stages[stage];
    const Camera camera =
        LevelCamera(spec_.problems[problem].camera, spec.level);
    const bool is_filtered = stage + 1 == num_stages() && spec_.filter;
    return (StageWork(spec) + (is_filtered ? kFilterWork : 0)) * camera.width *
           camera.height;
  }

  double Fraction() const {
    return total_work_ > 0 ? done_work_ / total_work_ : 1;
  }

  void Tell(const std::function<void(const RunProgress&)>& what,
            RunProgress event) const {
    event.fraction = Fraction();
    if (what) what(event);
  }

  void RunOneStage(int stage) {
    images_->StartStage(spec_.schedule.stages[stage].level);
    maps_->StartStage(stage);
    std::vector<int> problems;
    for (const int p : needed_[stage]) {
      if (has_failed_[p]) {
        done_work_ += WorkOf(stage, p);
      } else {
        problems.push_back(p);
      }
    }
    RunProgress event;
    event.stage = stage;
    event.num_problems = static_cast<int>(problems.size());
    num_started_ = 0;
    workers_->Run(problems, [&](Worker* worker, int problem) {
      RunProgress own = event;
      own.problem = problem;
      RunProblem(worker, own);
    });
    if (!unreadable_.empty()) throw UnreadableImages(unreadable_);
    // What was added up on the way is not exact.
    done_work_ = work_until_[stage];
    event.number = event.num_problems;
    Tell(events_.progress, event);
  }

  void RunProblem(Worker* worker, RunProgress event) {
    if (events_.cancel != nullptr) events_.cancel->ThrowIfCancelled();
    const double work = WorkOf(event.stage, event.problem);
    double counted = 0;  // of `work`, in done_work_
    const auto count = [&](double fraction) {
      const std::lock_guard<std::mutex> lock(mutex_);
      done_work_ += fraction * work - counted;
      counted = fraction * work;
      if (fraction < 1) Tell(events_.progress, event);
    };
    {
      const std::lock_guard<std::mutex> lock(mutex_);
      event.number = ++num_started_;
      Tell(events_.started, event);
    }
    const CancelToken never;
    RunControl control;
    control.cancel = events_.cancel != nullptr ? events_.cancel : &never;
    control.progress = count;
    try {
      RunStage(
          spec_, event.stage, event.problem, images_, maps_, worker, control);
    } catch (const UnreadableImages& error) {
      // Who needs none of these goes on: then all are known at once.
      const std::lock_guard<std::mutex> lock(mutex_);
      unreadable_.insert(error.reasons().begin(), error.reasons().end());
    } catch (const Error& error) {
      const std::lock_guard<std::mutex> lock(mutex_);
      if (error.code() != ErrorCode::kBadInput || !events_.failed) {
        // Another worker may take the problem.
        --num_started_;
        done_work_ -= counted;
        throw;
      }
      has_failed_[event.problem] = true;
      events_.failed(event.stage, event.problem, error);
    }
    count(1);
  }

  const RunSpec& spec_;
  ImageStore* images_;
  MapStore* maps_;
  WorkerPool* workers_;
  const RunEvents& events_;
  std::mutex mutex_;  // guards what follows while workers run, and the events
  std::vector<bool> has_failed_;          // by problem
  std::vector<std::vector<int>> needed_;  // problems, by stage
  double total_work_ = 0, done_work_ = 0;
  std::vector<double> work_until_;  // the end of each stage
  int num_started_ = 0;             // of the stage
  UnreadableImages::Reasons unreadable_;
};

}  // namespace

void RunSchedule(const RunSpec& spec,
                 ImageStore* images,
                 MapStore* maps,
                 WorkerPool* workers,
                 const RunEvents& events) {
  CheckSpec(spec);
  ScheduledRun(spec, images, maps, workers, events).Run();
}

}  // namespace hpm
