// An allocator for large arrays that are read at random: with huge pages the
// processor finds their addresses without walking its page tables.
#pragma once

#include "src/base/platform/pages.h"

#include <cstddef>
#include <cstdint>
#include <new>

namespace hpm {

constexpr size_t kHugePage = size_t{2} << 20;  // bytes

// For the whole huge pages within this memory; refusal does no harm.
inline void WishHugePages(void* memory, size_t num_bytes) {
  const auto address = reinterpret_cast<uintptr_t>(memory);
  const uintptr_t begin = (address + kHugePage - 1) / kHugePage * kHugePage;
  const uintptr_t end = (address + num_bytes) / kHugePage * kHugePage;
  if (begin < end)
    WishHuge(static_cast<char*>(memory) + (begin - address), end - begin);
}

template <class T>
struct HugePageAllocator {
  using value_type = T;

  HugePageAllocator() = default;
  template <class U>
  explicit HugePageAllocator(const HugePageAllocator<U>&) {}

  T* allocate(size_t count) {
    size_t bytes = count * sizeof(T);
    if (bytes < kHugePage) return static_cast<T*>(::operator new(bytes));
    bytes = (bytes + kHugePage - 1) / kHugePage * kHugePage;
    void* memory = AllocateAligned(kHugePage, bytes);
    if (memory == nullptr) throw std::bad_alloc();
    WishHugePages(memory, bytes);
    return static_cast<T*>(memory);
  }

  void deallocate(T* memory, size_t count) {
    if (count * sizeof(T) < kHugePage) {
      ::operator delete(memory);
    } else {
      FreeAligned(memory);
    }
  }

  bool operator==(const HugePageAllocator&) const { return true; }
  bool operator!=(const HugePageAllocator&) const { return false; }
};

}  // namespace hpm
