// See parallel_for.h in this folder.
#pragma once

#include <mutex>

#include <tbb/parallel_for.h>

namespace tbb {

template <class Index, class Value, class Body, class Join>
Value parallel_reduce(const blocked_range<Index>& range,
                      const Value& identity,
                      const Body& body,
                      const Join& join) {
  std::mutex mutex;
  Value result = identity;
  parallel_for(range, [&](const blocked_range<Index>& part) {
    const Value value = body(part, identity);
    const std::lock_guard<std::mutex> lock(mutex);
    result = join(result, value);
  });
  return result;
}

}  // namespace tbb
