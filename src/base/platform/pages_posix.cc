#include "src/base/platform/pages.h"

#include <cstdlib>

#include <sys/mman.h>

namespace hpm {

void* AllocateAligned(size_t alignment, size_t num_bytes) {
  void* memory = nullptr;
  return posix_memalign(&memory, alignment, num_bytes) == 0 ? memory : nullptr;
}

void FreeAligned(void* memory) { std::free(memory); }

void WishHuge(void* begin, size_t num_bytes) {
#ifdef MADV_HUGEPAGE
  madvise(begin, num_bytes, MADV_HUGEPAGE);
#else
  static_cast<void>(begin);
  static_cast<void>(num_bytes);
#endif
}

}  // namespace hpm
