// Memory and disk a run will take, known before it starts.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "src/engine/backend.h"

#include <cstdint>
#include <vector>

namespace hpm {

// Largest need over all problems, in bytes.
struct MemoryNeeds {
  uint64_t working = 0;  // of the backend and the maps being written
  uint64_t inputs = 0;   // images and depth maps of one problem
};

MemoryNeeds LargestNeeds(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const Backend& backend,
                         bool geometric);

// Of --PatchMatchStereo.cache_size, which may be absurdly large.
uint64_t CacheBytes(double gibibytes);

uint64_t BytesToWrite(const std::vector<StereoProblem>& problems,
                      const StagePlan& plan);

}  // namespace hpm
