#include "src/engine/work_estimate.h"

#include <algorithm>

namespace hpm {
namespace {

// One hypothesis per pixel, in all views, beside the dozens of an iteration.
constexpr double kStartWork = 0.15;
// From scenes with few plain surfaces to one that has many, 0.13 to 0.6.
constexpr double kMiningWork = 0.45;
// A tenth of a geometric pass.
constexpr double kPropagationWork = 0.035;
// Fewer regions, fewer views, no hypotheses from the whole range; but the
// sources' depths are looked at, too.
constexpr double kFewViewsIteration = 0.6;

}  // namespace

double JudgeWork(const StageSpec& stage) {
  return stage.from_coarser && !stage.passes.empty() ? kStartWork : 0;
}

double PriorWork(const Pass& pass) {
  return (pass.regions != RegionPriors::kNone ? kMiningWork : 0) +
         (pass.propagate_views ? kPropagationWork : 0);
}

double StepsWork(const Pass& pass, int num_steps) {
  const int num_start = std::min(num_steps, pass.NumStartSteps());
  const double iteration = pass.few_views ? kFewViewsIteration : 1;
  return 0.5 * (kStartWork * num_start + iteration * (num_steps - num_start));
}

double PassWork(const Pass& pass) { return StepsWork(pass, pass.NumSteps()); }

double StageWork(const StageSpec& stage) {
  double work = JudgeWork(stage);
  for (const Pass& pass : stage.passes)
    work += PriorWork(pass) + PassWork(pass);
  return work;
}

}  // namespace hpm
