// A pass as the list of its half-sweeps, in order.
#pragma once

#include "src/core/sweep.h"
#include "src/engine/pass.h"

#include <cstdint>
#include <vector>

namespace hpm {

std::vector<Sweep> SweepsOf(const Pass& pass, uint64_t random_key);

// The filter of finished maps.
std::vector<Sweep> ConsistencySweeps(const FilterParams& filter,
                                     bool geometric);

}  // namespace hpm
