// Whether a run fits into memory, decided before it starts.
#pragma once

#include <cstdint>

namespace hpm {

// The program itself, libraries, decoders, stacks of threads: at most, and in a
// run on the CPU (0.06 to 0.07 GiB were seen).
constexpr uint64_t kOverheadBytes = 200ull << 20;
constexpr uint64_t kUsualOverheadBytes = 64ull << 20;

// Bytes this process may use: the least of physical memory, the control group's
// limit and the address space limit (ulimit -v).
uint64_t MemoryLimit();

// Bytes for the cache of inputs: as asked, but not more than pays - the inputs
// of one problem, of which the next shares most, or half a gibibyte - and never
// more than what `limit` leaves beside `working_bytes` (the largest problem).
// Throws Error(kOutOfResources), naming the option to change, if even the
// smallest useful cache (`min_cache_bytes`, the inputs of one problem) does not
// fit.
uint64_t PlanCacheBytes(uint64_t asked_bytes,
                        uint64_t working_bytes,
                        uint64_t min_cache_bytes,
                        uint64_t limit);

}  // namespace hpm
