// See parallel_for.h in this folder.
#pragma once

#include <cstddef>

namespace tbb {

class global_control {
 public:
  enum parameter { max_allowed_parallelism, thread_stack_size };
  global_control(parameter, size_t) {}
  static size_t active_value(parameter) { return size_t{1} << 20; }
};

}  // namespace tbb
