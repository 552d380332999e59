// The CPU backend: SIMD matching cost, threads over bands of rows.
#pragma once

#include "src/engine/backend.h"

#include <memory>
#include <string>

namespace hpm {

// `target`: see FindCpuTarget; num_threads <= 0: all cores.
std::unique_ptr<Backend> MakeCpuBackend(const std::string& target,
                                        int num_threads);

}  // namespace hpm
