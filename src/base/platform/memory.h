// How much memory there is, and how much was used.
#pragma once

#include <cstdint>

namespace hpm {

// Of the machine; 0 where unknown.
uint64_t PhysicalMemoryBytes();
// That this process may have (ulimit -v); UINT64_MAX where there is no limit.
uint64_t AddressSpaceLimit();
// The most that this process has used so far; 0 where unknown.
uint64_t PeakMemoryBytes();

}  // namespace hpm
