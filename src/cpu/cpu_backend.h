// The CPU backend: SIMD matching cost, threads over bands of rows.
#pragma once

#include <memory>
#include <string>

#include "src/engine/backend.h"

namespace hpm {

// `target`: see FindCpuTarget; num_threads <= 0: all cores.
std::unique_ptr<Backend> MakeCpuBackend(const std::string& target, int num_threads);

}  // namespace hpm
