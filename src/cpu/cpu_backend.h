// The CPU backend: SIMD matching cost, threads over bands of rows.
#pragma once

#include "src/cpu/cpu_target.h"
#include "src/engine/backend.h"

#include <memory>
#include <string>

namespace hpm {

// num_threads <= 0: all cores.
std::unique_ptr<Backend> MakeCpuBackend(const CpuTarget& target,
                                        int num_threads);
// `target`: see FindCpuTarget.
std::unique_ptr<Backend> MakeCpuBackend(const std::string& target,
                                        int num_threads);

}  // namespace hpm
