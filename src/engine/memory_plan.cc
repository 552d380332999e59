#include "src/engine/memory_plan.h"

#include "src/base/error.h"
#include "src/base/platform/memory.h"
#include "src/base/remedies.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr uint64_t kPlentyBytes = 512ull << 20;

uint64_t ControlGroupLimit() {
  for (const char* path : {"/sys/fs/cgroup/memory.max",
                           "/sys/fs/cgroup/memory/memory.limit_in_bytes"}) {
    std::ifstream file(path);
    uint64_t bytes = 0;
    if (file >> bytes && bytes > 0) return bytes;  // "max" does not parse
  }
  return UINT64_MAX;
}

}  // namespace

uint64_t MemoryLimit() {
  uint64_t limit = ControlGroupLimit();
  const uint64_t physical = PhysicalMemoryBytes();
  if (physical > 0) limit = std::min(limit, physical);
  return std::min(limit, AddressSpaceLimit());
}

uint64_t PlanCacheBytes(uint64_t asked_bytes,
                        uint64_t working_bytes,
                        uint64_t min_cache_bytes,
                        uint64_t limit) {
  const uint64_t need = kOverheadBytes + working_bytes + min_cache_bytes;
  if (need > limit) {
    throw Error(
        ErrorCode::kOutOfResources,
        fmt::format(
            "one image needs about {} MB of memory and {} MB may be used; use "
            "{} or fewer sources in patch-match.cfg",
            need >> 20,
            limit >> 20,
            kSmallerImages));
  }
  const uint64_t paying = std::max(kPlentyBytes, min_cache_bytes);
  return std::clamp(std::min(asked_bytes, paying),
                    min_cache_bytes,
                    limit - kOverheadBytes - working_bytes);
}

}  // namespace hpm
