#include "src/engine/schedule.h"

#include "src/core/sampling_pattern.h"

#include <algorithm>

namespace hpm {
namespace {

// The numbers of a run: those given, else the method's own.
MethodNumbers NumbersOf(const Method& method, const ScheduleOptions& options) {
  const auto either = [](int given, int own) {
    return given < 0 ? own : given;
  };
  const MethodNumbers& own = method.numbers;
  return {either(options.num_iterations, own.num_iterations),
          either(options.num_geom_iterations, own.num_geom_iterations),
          either(options.num_geom_passes, own.num_geom_passes),
          either(options.num_fine_iterations, own.num_fine_iterations),
          either(options.num_fine_geom_passes, own.num_fine_geom_passes),
          own.max_views};
}

// Levels at which triangles make priors, coarsest first.
std::vector<int> PriorLevels(Priors priors, int num_levels) {
  switch (priors) {
    case Priors::kNone:
    case Priors::kRegions:
      return {};
    case Priors::kFull:
      return {0};
    case Priors::kCoarsest:
      return {num_levels - 1};
    case Priors::kAll:
      break;
  }
  std::vector<int> levels;
  for (int level = num_levels - 1; level >= 0; --level) levels.push_back(level);
  return levels;
}

// Appends the stages of one method, coarse to fine.
class StageList {
 public:
  StageList(const Method& method,
            const ScheduleOptions& options,
            std::vector<StageSpec>* stages)
      : method_(method),
        numbers_(NumbersOf(method, options)),
        num_levels_(options.num_levels),
        stages_(stages) {}

  void AddAll() {
    if (method_.priors == Priors::kRegions) {
      AddRegionStages();
    } else {
      AddPaperStages();
    }
  }

 private:
  void AddPaperStages() {
    const int coarsest = method_.pyramid ? num_levels_ - 1 : 0;
    for (int level = coarsest; level >= 0; --level) {
      AddPhotometric(level,
                     level < coarsest ? StartFrom::kStored : StartFrom::kRandom,
                     numbers_.num_iterations,
                     PriorLevels(method_.priors, num_levels_),
                     numbers_.num_geom_passes);
      for (int i = 0; i < numbers_.num_geom_passes; ++i)
        AddGeometric(level, RegionPriors::kNone, false, false);
    }
  }

  // A coarse level sees surfaces that a fine one does not, and hands them down.
  // What is textured is searched anew at every level: fine detail cannot be
  // found at a coarse one.
  void AddRegionStages() {
    const int coarsest = num_levels_ - 1;
    for (int level = coarsest; level >= 0; --level) {
      const bool is_coarsest = level == coarsest;
      int num_iterations =
          is_coarsest ? numbers_.num_iterations : numbers_.num_fine_iterations;
      int num_geom_passes = is_coarsest ? numbers_.num_geom_passes
                                        : numbers_.num_fine_geom_passes;
      if (numbers_.num_geom_passes == 0) {
        // Nobody visits the other half later: whole visits, half as often.
        if (!is_coarsest) num_iterations = (num_iterations + 1) / 2;
        num_iterations = std::max(1, num_iterations);
        num_geom_passes = 0;
      }
      AddPhotometric(level,
                     is_coarsest ? StartFrom::kRandom : StartFrom::kMissing,
                     num_iterations,
                     {},
                     num_geom_passes);
      for (int i = 0; i < num_geom_passes; ++i) {
        const bool last = i + 1 == num_geom_passes;
        AddGeometric(
            level,
            last && level == 0 ? RegionPriors::kStrong : RegionPriors::kWeak,
            method_.departures.triangles && is_coarsest && i == 0 && !last,
            last);
      }
    }
  }

  // Basic passes, then prior-assisted ones on the triangles of `prior_levels`.
  // Without any pass the stage hands on what came up from the coarser level;
  // the last one of the run does not, for a filter asks what was matched.
  void AddPhotometric(int level,
                      StartFrom start,
                      int num_iterations,
                      const std::vector<int>& prior_levels,
                      int num_geom_passes_after) {
    if (level == 0 && num_geom_passes_after == 0 && prior_levels.empty())
      num_iterations = std::max(1, num_iterations);
    StageSpec stage;
    stage.level = level;
    stage.from_coarser = start != StartFrom::kRandom;
    const int id = next_id_++;
    if (num_iterations > 0) {
      Pass pass = NewPass(PassKind::kBasic, start, num_iterations, id);
      pass.half_visits = method_.departures.half_visits &&
                         start == StartFrom::kMissing &&
                         num_geom_passes_after > 0;
      pass.rest_plain =
          method_.departures.rest_plain && start == StartFrom::kRandom;
      stage.passes.push_back(pass);
    }
    for (const int prior_level : prior_levels) {
      Pass pass = NewPass(PassKind::kPrior,
                          StartFrom::kPrior,
                          numbers_.num_iterations,
                          next_id_++);
      pass.level = prior_level;
      stage.passes.push_back(pass);
    }
    stages_->push_back(stage);
  }

  void AddGeometric(int level,
                    RegionPriors regions,
                    bool triangles,
                    bool last_of_level) {
    const Departures& departures = method_.departures;
    StageSpec stage;
    stage.level = level;
    stage.geometric = true;
    Pass pass = NewPass(PassKind::kGeometric,
                        StartFrom::kCurrent,
                        numbers_.num_geom_iterations,
                        next_id_++);
    pass.regions = regions;
    pass.triangles = triangles;
    pass.search_near = departures.search_near;
    pass.max_candidates = departures.geom_candidates;
    pass.max_views = departures.geom_views;
    pass.few_views = departures.geom_views < kMaxViews;
    pass.half_visits = departures.half_visits && !last_of_level;
    pass.propagate_views = departures.propagate_views;
    pass.fit_planes = departures.fit_planes && last_of_level && level == 0;
    stage.passes.push_back(pass);
    stages_->push_back(stage);
  }

  Pass NewPass(PassKind kind, StartFrom start, int num_iterations, int id) {
    Pass pass = {kind, start, num_iterations, id};
    pass.ask_all_views = method_.departures.ask_all_views;
    return pass;
  }

  const Method& method_;
  const MethodNumbers numbers_;
  const int num_levels_;
  std::vector<StageSpec>* stages_;
  int next_id_ = 0;
};

}  // namespace

Schedule MakeSchedule(const ScheduleOptions& options) {
  const Method& method = FindMethod(options.method);
  Schedule schedule;
  schedule.pattern = MakeSamplingPattern(method.non_local, method.extensible);
  StageList(method, options, &schedule.stages).AddAll();
  return schedule;
}

}  // namespace hpm
