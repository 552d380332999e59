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
};

constexpr Method kMethods[] = {
    {"acmh", false, false, Priors::kNone},
    {"nsp", true, false, Priors::kNone},
    {"esp", false, true, Priors::kNone},
    {"nesp", true, true, Priors::kNone},
    {"nesp_pa", true, true, Priors::kFull},
    {"hpm_fast_no_nesp", false, false, Priors::kCoarsest},
    {"hpm_no_nesp", false, false, Priors::kAll},
    {"hpm_fast", true, true, Priors::kCoarsest},
    {"hpm", true, true, Priors::kAll},
};

// Halvings until the longer side is at most this many pixels
// (specification 1.2).
constexpr int kCoarsestSide = 1000;

// Levels of the prior hierarchy, coarsest first.
std::vector<int> PriorLevels(Priors priors,
                             int num_levels,
                             int width,
                             int height) {
  if (priors == Priors::kNone) return {};
  if (priors == Priors::kFull) return {0};
  if (num_levels < 0) {
    num_levels = 1;
    for (int side = std::max(width, height); side > kCoarsestSide; side /= 2)
      ++num_levels;
  }
  std::vector<int> levels;
  for (int level = num_levels - 1; level >= 0; --level) levels.push_back(level);
  if (priors == Priors::kCoarsest && !levels.empty()) levels.resize(1);
  return levels;
}

}  // namespace

std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const Method& method : kMethods) names.push_back(method.name);
  return names;
}

Schedule MakeSchedule(const ScheduleOptions& options, int width, int height) {
  for (const Method& method : kMethods) {
    if (options.method != method.name) continue;
    Schedule schedule;
    schedule.pattern = MakeSamplingPattern(method.non_local, method.extensible);
    int id = 0;
    schedule.photometric.push_back({PassKind::kBasic,
                                    StartFrom::kRandom,
                                    options.num_iterations,
                                    id++,
                                    0});
    for (const int level :
         PriorLevels(method.priors, options.num_levels, width, height)) {
      schedule.photometric.push_back({PassKind::kPrior,
                                      StartFrom::kPrior,
                                      options.num_iterations,
                                      id++,
                                      level});
    }
    for (int i = 0; i < options.num_geom_passes; ++i) {
      schedule.geometric.push_back({PassKind::kGeometric,
                                    StartFrom::kCurrent,
                                    options.num_geom_iterations,
                                    id++,
                                    0});
    }
    return schedule;
  }
  std::string names;
  for (const std::string& name : MethodNames())
    names += (names.empty() ? "" : ", ") + name;
  throw Error(
      ErrorCode::kUsage,
      "--Hpm.method " + options.method + ": unknown; use one of " + names);
}

}  // namespace hpm
