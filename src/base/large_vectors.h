// Large arrays whose memory is fetched from the system by all threads: one
// alone spends more time on that than on writing to it.
#pragma once

#include "src/base/huge_pages.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <tbb/parallel_for.h>

namespace hpm {

// Has the system provide memory that nothing stands in yet. A huge page is one
// thread's, for two that ask for it at once both clear one.
inline void TouchPages(void* memory, size_t num_bytes) {
  constexpr size_t kPage = 4096;
  WishHugePages(memory, num_bytes);
  auto* bytes = static_cast<volatile char*>(memory);
  const size_t offset = reinterpret_cast<uintptr_t>(memory) % kHugePage;
  const size_t num_huge = (offset + num_bytes + kHugePage - 1) / kHugePage;
  tbb::parallel_for(size_t{0}, num_huge, [&](size_t i) {
    const size_t begin = i == 0 ? 0 : i * kHugePage - offset;
    const size_t end = std::min(num_bytes, (i + 1) * kHugePage - offset);
    for (size_t at = begin; at < end; at += kPage) bytes[at] = 0;
  });
}

template <class T>
std::vector<T> Filled(size_t size, const T& value) {
  std::vector<T> result;
  result.reserve(size);
  TouchPages(result.data(), size * sizeof(T));
  result.assign(size, value);
  return result;
}

template <class T>
std::vector<T> Copied(const std::vector<T>& original) {
  std::vector<T> result;
  result.reserve(original.size());
  TouchPages(result.data(), original.size() * sizeof(T));
  result = original;
  return result;
}

}  // namespace hpm
