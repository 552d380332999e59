#include "src/engine/schedule.h"

#include "src/base/error.h"
#include "src/core/sampling_pattern.h"

namespace hpm {
namespace {

struct Method {
  const char* name;
  bool non_local;   // N of the paper's ablation
  bool extensible;  // E
};

constexpr Method kMethods[] = {
    {"acmh", false, false},
    {"nsp", true, false},
    {"esp", false, true},
    {"nesp", true, true},
};

}  // namespace

std::vector<std::string> MethodNames() {
  std::vector<std::string> names;
  for (const Method& method : kMethods) names.push_back(method.name);
  return names;
}

Schedule MakeSchedule(const ScheduleOptions& options) {
  for (const Method& method : kMethods) {
    if (options.method != method.name) continue;
    Schedule schedule;
    schedule.pattern = MakeSamplingPattern(method.non_local, method.extensible);
    int id = 0;
    schedule.photometric.push_back(
        {PassKind::kBasic, StartFrom::kRandom, options.num_iterations, id++, 0});
    for (int i = 0; i < options.num_geom_passes; ++i) {
      schedule.geometric.push_back(
          {PassKind::kGeometric, StartFrom::kCurrent, options.num_geom_iterations, id++, 0});
    }
    return schedule;
  }
  std::string names;
  for (const std::string& name : MethodNames()) names += (names.empty() ? "" : ", ") + name;
  throw Error(ErrorCode::kUsage,
              "--Hpm.method " + options.method + ": unknown; use one of " + names);
}

}  // namespace hpm
