#include "src/engine/schedule.h"

#include "src/base/error.h"
#include "src/core/sampling_pattern.h"

namespace hpm {
namespace {

// At which levels a method builds priors.
enum class Priors { kNone, kFull, kCoarsest, kAll };

struct Method {
  const char* name;
  bool non_local;   // N of the paper's ablation
  bool extensible;  // E
  Priors priors;
  bool regions;  // priors for weak regions in geometric passes
  bool pyramid;  // runs on images of all levels, coarse to fine (ACMM)
};

constexpr Method kMethods[] = {
    {"acmh", false, false, Priors::kNone, false, false},
    {"nsp", true, false, Priors::kNone, false, false},
    {"esp", false, true, Priors::kNone, false, false},
    {"nesp", true, true, Priors::kNone, false, false},
    {"nesp_pa", true, true, Priors::kFull, false, false},
    {"hpm_fast_no_nesp", false, false, Priors::kCoarsest, true, false},
    {"hpm_no_nesp", false, false, Priors::kAll, true, false},
    {"hpm_fast", true, true, Priors::kCoarsest, true, false},
    {"hpm", true, true, Priors::kAll, true, false},
    {"acmm", false, false, Priors::kNone, false, true},
    {"acmp", false, false, Priors::kFull, false, false},
    {"acmmp", false, false, Priors::kFull, false, true},
    {"acmm_nesp", true, true, Priors::kNone, false, true},
    {"acmp_nesp", true, true, Priors::kFull, false, false},
    {"acmmp_nesp", true, true, Priors::kFull, false, true},
};

// Levels at which priors are built, coarsest first.
std::vector<int> PriorLevels(Priors priors, int num_levels) {
  if (priors == Priors::kNone) return {};
  if (priors == Priors::kFull) return {0};
  std::vector<int> levels;
  for (int level = num_levels - 1; level >= 1; --level) levels.push_back(level);
  if (priors == Priors::kCoarsest && !levels.empty()) levels.resize(1);
  return levels;
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
    int id = 0;
    const int coarsest = method.pyramid ? options.num_levels - 1 : 0;
    for (int level = coarsest; level >= 0; --level) {
      StageSpec photometric;
      photometric.level = level;
      photometric.from_coarser = level < coarsest;
      photometric.passes.push_back(
          {PassKind::kBasic,
           photometric.from_coarser ? StartFrom::kCurrent : StartFrom::kRandom,
           options.num_iterations,
           id++});
      for (const int prior_level :
           PriorLevels(method.priors, options.num_levels)) {
        photometric.passes.push_back({PassKind::kPrior,
                                      StartFrom::kPrior,
                                      options.num_iterations,
                                      id++,
                                      prior_level});
      }
      schedule.stages.push_back(photometric);
      const int num_geom_passes = method.priors == Priors::kCoarsest
                                      ? (options.num_geom_passes + 1) / 2
                                      : options.num_geom_passes;
      for (int i = 0; i < num_geom_passes; ++i) {
        StageSpec geometric;
        geometric.level = level;
        geometric.geometric = true;
        geometric.passes.push_back({PassKind::kGeometric,
                                    StartFrom::kCurrent,
                                    options.num_geom_iterations,
                                    id++,
                                    0,
                                    true,
                                    !method.regions ? RegionPriors::kNone
                                    : i + 1 == num_geom_passes
                                        ? RegionPriors::kStrong
                                        : RegionPriors::kWeak});
        schedule.stages.push_back(geometric);
      }
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
  constexpr int kCoarsestSide = 1000;
  int num_levels = 1;
  for (; side > kCoarsestSide; side /= 2) ++num_levels;
  return num_levels;
}

}  // namespace hpm
