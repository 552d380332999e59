// The SIMD targets' matching costs.
#pragma once

#include "src/cpu/match_cost.h"

#include <cstdint>

namespace hpm {

// Of one of Highway's targets, among those that this machine can run.
MatchCostFunction SimdMatchCosts(int64_t target);
// Floats in a vector.
int SimdLanes(int64_t target);

}  // namespace hpm
