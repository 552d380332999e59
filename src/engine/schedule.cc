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

// Levels at which priors are built, coarsest first.
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
      for (int i = 0; i < options.num_geom_passes; ++i) {
        StageSpec geometric;
        geometric.level = level;
        geometric.geometric = true;
        geometric.passes.push_back({PassKind::kGeometric,
                                    StartFrom::kCurrent,
                                    options.num_geom_iterations,
                                    id++});
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
