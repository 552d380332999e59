#include "src/base/platform/memory.h"

// psapi.h needs what windows.h declares.
#include <windows.h>
// clang-format off
#include <psapi.h>
// clang-format on

namespace hpm {

uint64_t PhysicalMemoryBytes() {
  MEMORYSTATUSEX status = {};
  status.dwLength = sizeof(status);
  return GlobalMemoryStatusEx(&status) ? status.ullTotalPhys : 0;
}

uint64_t AddressSpaceLimit() { return UINT64_MAX; }

uint64_t PeakMemoryBytes() {
  PROCESS_MEMORY_COUNTERS counters = {};
  return K32GetProcessMemoryInfo(
             GetCurrentProcess(), &counters, sizeof(counters))
             ? counters.PeakWorkingSetSize
             : 0;
}

}  // namespace hpm
