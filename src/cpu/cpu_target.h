// The instruction sets that this binary can use, chosen at run time.
#pragma once

#include "src/cpu/geometric_error.h"
#include "src/cpu/match_cost.h"

#include <string>
#include <vector>

namespace hpm {

struct CpuTarget {
  std::string name;  // "scalar", "sse4", "avx2", "avx3", "neon", ...
  MatchCostFunction match_costs = nullptr;
  GeometricErrorFunction geometric_errors = nullptr;
  int num_lanes = 1;  // floats in a vector, at most kMaxGroup
};

// All targets that this binary holds and this machine can run, best first,
// "scalar" (the code of src/core) last.
std::vector<CpuTarget> CpuTargets();

// `name` = "auto" gives the best one. Throws Error(kUsage) listing the names.
CpuTarget FindCpuTarget(const std::string& name);

}  // namespace hpm
