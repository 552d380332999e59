// A pass as the list of its half-sweeps. The keys of the random numbers are
// those of the CPU backend.
#pragma once

#include "cuda/pixel_kernels.h"
#include "src/engine/pass.h"

#include <vector>

namespace hpm {

std::vector<Sweep> SweepsOf(const Pass& pass, uint64_t random_key);

// The filter of finished maps.
std::vector<Sweep> ConsistencySweeps(const FilterParams& filter,
                                     bool geometric);

}  // namespace hpm
