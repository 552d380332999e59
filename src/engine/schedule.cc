#include "src/engine/schedule.h"

#include "src/base/error.h"
#include "src/core/sampling_pattern.h"

#include <algorithm>

namespace hpm {
namespace {

// At which levels a method builds priors.
enum class Priors { kNone, kFull, kCoarsest, kAll };

struct Method {
  const char* name;
  bool non_local;   // N of the paper's ablation
  bool extensible;  // E
  Priors priors;
  bool pyramid;  // runs on images of all levels, coarse to fine (ACMM)
};

constexpr Method kMethods[] = {
    {"acmh", false, false, Priors::kNone, false},
    {"nsp", true, false, Priors::kNone, false},
    {"esp", false, true, Priors::kNone, false},
    {"nesp", true, true, Priors::kNone, false},
    {"nesp_pa", true, true, Priors::kFull, false},
    {"hpm_fast_no_nesp", false, false, Priors::kCoarsest, false},
    {"hpm_no_nesp", false, false, Priors::kAll, false},
    {"hpm_fast", true, true, Priors::kCoarsest, false},
    {"hpm", true, true, Priors::kAll, false},
    {"acmm", false, false, Priors::kNone, true},
    {"acmp", false, false, Priors::kFull, false},
    {"acmmp", false, false, Priors::kFull, true},
    {"acmm_nesp", true, true, Priors::kNone, true},
    {"acmp_nesp", true, true, Priors::kFull, false},
    {"acmmp_nesp", true, true, Priors::kFull, true},
};

// Levels at which triangles make priors, coarsest first.
std::vector<int> PriorLevels(Priors priors, int num_levels) {
  switch (priors) {
    case Priors::kNone:
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
  StageList(const ScheduleOptions& options,
            bool fast,
            std::vector<StageSpec>* stages)
      : options_(options), fast_(fast), stages_(stages) {}

  // Basic passes, then prior-assisted ones on the triangles of `prior_levels`.
  // Without any pass the stage hands on what came up from the coarser level.
  void AddPhotometric(int level,
                      bool from_coarser,
                      int num_iterations,
                      const std::vector<int>& prior_levels) {
    StageSpec stage;
    stage.level = level;
    stage.from_coarser = from_coarser;
    const int id = next_id_++;
    if (num_iterations > 0) {
      stage.passes.push_back(
          {PassKind::kBasic,
           from_coarser ? StartFrom::kStored : StartFrom::kRandom,
           num_iterations,
           id});
    }
    for (const int prior_level : prior_levels) {
      stage.passes.push_back({PassKind::kPrior,
                              StartFrom::kPrior,
                              options_.num_iterations,
                              next_id_++,
                              prior_level});
    }
    stages_->push_back(stage);
  }

  void AddGeometric(int level, RegionPriors regions, bool half) {
    StageSpec stage;
    stage.level = level;
    stage.geometric = true;
    Pass pass = {PassKind::kGeometric,
                 StartFrom::kCurrent,
                 options_.num_geom_iterations,
                 next_id_++};
    pass.regions = regions;
    pass.max_candidates = fast_ ? 3 : 4;
    if (regions != RegionPriors::kNone) {
      pass.max_drawn_views = 2;
      pass.few_views = true;
    }
    pass.half = half;
    stage.passes.push_back(pass);
    stages_->push_back(stage);
  }

 private:
  const ScheduleOptions& options_;
  const bool fast_;
  std::vector<StageSpec>* stages_;
  int next_id_ = 0;
};

// The paper's methods.
void AddStages(const Method& method,
               const ScheduleOptions& options,
               StageList* list) {
  const int coarsest = method.pyramid ? options.num_levels - 1 : 0;
  for (int level = coarsest; level >= 0; --level) {
    list->AddPhotometric(level,
                         level < coarsest,
                         options.num_iterations,
                         PriorLevels(method.priors, options.num_levels));
    for (int i = 0; i < options.num_geom_passes; ++i)
      list->AddGeometric(level, RegionPriors::kNone, false);
  }
}

// Priors mined from what the views agree on, at every level of the images: a
// coarse level sees walls that a fine one does not, and hands them down. There
// everything is found; finer levels sharpen it.
void AddRegionStages(bool fast,
                     const ScheduleOptions& options,
                     StageList* list) {
  const int coarsest = options.num_levels - 1;
  const int search_iterations =
      std::max(1, options.num_iterations - (fast ? 1 : 0));
  const bool half_search = options.num_geom_passes > 0 &&
                           (options.half_search == HalfSearch::kAuto
                                ? fast || options.num_levels == 1
                                : options.half_search == HalfSearch::kOn);
  // A quarter of the pixels: one iteration more is cheap.
  if (half_search)
    list->AddPhotometric(coarsest + 1, false, search_iterations + 1, {});
  for (int level = coarsest; level >= 0; --level) {
    const bool is_coarsest = level == coarsest;
    int num_iterations = is_coarsest ? (half_search ? 0 : search_iterations)
                                     : (fast ? 0 : options.num_fine_iterations);
    int num_geom_passes =
        is_coarsest ? options.num_geom_passes : options.num_fine_geom_passes;
    if (fast) num_geom_passes = (num_geom_passes + 1) / 2;
    if (options.num_geom_passes == 0) {
      num_iterations = std::max(1, num_iterations);
      num_geom_passes = 0;
    }
    list->AddPhotometric(
        level, half_search || !is_coarsest, num_iterations, {});
    for (int i = 0; i < num_geom_passes; ++i) {
      const bool last = i + 1 == num_geom_passes;
      list->AddGeometric(
          level,
          last && level == 0 ? RegionPriors::kStrong : RegionPriors::kWeak,
          fast || !last);
    }
  }
}

}  // namespace

std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const Method& method : kMethods) names.emplace_back(method.name);
  return names;
}

Schedule MakeSchedule(const ScheduleOptions& options) {
  for (const Method& method : kMethods) {
    if (options.method != method.name) continue;
    Schedule schedule;
    schedule.pattern = MakeSamplingPattern(method.non_local, method.extensible);
    const bool regions =
        options.region_priors &&
        (method.priors == Priors::kCoarsest || method.priors == Priors::kAll);
    const bool fast = regions && method.priors == Priors::kCoarsest;
    StageList list(options, fast, &schedule.stages);
    if (regions) {
      AddRegionStages(fast, options, &list);
    } else {
      AddStages(method, options, &list);
    }
    return schedule;
  }
  std::string names;
  for (const std::string& name : MethodNames()) {
    names += (names.empty() ? "" : ", ") + name;
  }
  throw Error(
      ErrorCode::kUsage,
      "--Hpm.method " + options.method + ": unknown; use one of " + names);
}

int AutomaticLevels(int side) {
  constexpr int kCoarsestSide = 500;
  int num_levels = 1;
  for (; side > kCoarsestSide; side /= 2) ++num_levels;
  return num_levels;
}

}  // namespace hpm
