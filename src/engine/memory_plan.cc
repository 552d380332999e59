#include "src/engine/memory_plan.h"

#include "src/base/error.h"

#include <algorithm>
#include <fstream>
#include <string>

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

namespace hpm {
namespace {

// The program itself, libraries, decoders, stacks of threads.
constexpr uint64_t kOverheadBytes = 200ull << 20;

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
  const long pages = sysconf(_SC_PHYS_PAGES);
  const long page_bytes = sysconf(_SC_PAGESIZE);
  if (pages > 0 && page_bytes > 0) {
    limit = std::min(
        limit,
        static_cast<uint64_t>(pages) * static_cast<uint64_t>(page_bytes));
  }
  rlimit address_space = {};
  if (getrlimit(RLIMIT_AS, &address_space) == 0 &&
      address_space.rlim_cur != RLIM_INFINITY) {
    limit = std::min(limit, static_cast<uint64_t>(address_space.rlim_cur));
  }
  return limit;
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
            "one image needs about {} MB of memory and {} MB may be used; set "
            "a "
            "smaller --PatchMatchStereo.max_image_size or fewer sources in "
            "patch-match.cfg",
            need >> 20,
            limit >> 20));
  }
  const uint64_t paying = std::max(kPlentyBytes, min_cache_bytes);
  return std::clamp(std::min(asked_bytes, paying),
                    min_cache_bytes,
                    limit - kOverheadBytes - working_bytes);
}

}  // namespace hpm
