// What the parts of a run take beside each other, for the time that a user is
// told is left. Measured shares of the CPU's time; no result depends on them.
#pragma once

#include "src/engine/schedule.h"

namespace hpm {

// The unit, per pixel: an iteration that looks into all regions and asks all
// views that seem good.
constexpr double kFilterWork = 0.17;

// Before a stage's first pass, and before each pass.
double JudgeWork(const StageSpec& stage);
double PriorWork(const Pass& pass);

// Of the first `num_steps` half-sweeps of the pass, of which NumSteps() count.
double StepsWork(const Pass& pass, int num_steps);
double PassWork(const Pass& pass);

// All of these but the filter.
double StageWork(const StageSpec& stage);

}  // namespace hpm
