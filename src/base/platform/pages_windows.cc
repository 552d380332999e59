#include "src/base/platform/pages.h"

#include <malloc.h>

namespace hpm {

void* AllocateAligned(size_t alignment, size_t num_bytes) {
  return _aligned_malloc(num_bytes, alignment);
}

void FreeAligned(void* memory) { _aligned_free(memory); }

// Huge pages there need a right that users seldom have.
void WishHuge(void*, size_t) {}

}  // namespace hpm
