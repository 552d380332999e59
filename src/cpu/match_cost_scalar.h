// The matching cost of src/core/match_cost.h as it stands there, one pair at a
// time: the reference for all SIMD targets, and a target of its own.
#pragma once

#include "src/cpu/match_cost.h"

namespace hpm {

// See MatchCostFunction.
void ScalarMatchCosts(const MatchViews& match,
                      const RefPatches& patches,
                      const MatchRequest* requests,
                      int num_requests);

}  // namespace hpm
