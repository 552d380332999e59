// Memory by its pages.
#pragma once

#include <cstddef>

namespace hpm {

// nullptr where there is none. num_bytes is a multiple of the alignment, a
// power of two. Goes back by FreeAligned() alone.
void* AllocateAligned(size_t alignment, size_t num_bytes);
void FreeAligned(void* memory);

// That these bytes, which begin and end on pages, lie in huge pages; refusal
// does no harm.
void WishHuge(void* begin, size_t num_bytes);

}  // namespace hpm
