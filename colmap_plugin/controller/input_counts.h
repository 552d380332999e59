// How often a run read its inputs.
#pragma once

#include <cstdint>

namespace hpm {

// Files that were read because the cache did not have what is in them.
struct InputCounts {
  uint64_t images = 0;
  uint64_t depth_maps = 0;
};

}  // namespace hpm
