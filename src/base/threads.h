// How many threads the system grants. Libraries end the program where they
// cannot start one, so it is asked before they try.
#pragma once

#include "src/base/error.h"

#include <cstddef>

namespace hpm {

// Starts up to `most` threads with stacks of `stack_bytes`, all alive at the
// same time, ends them and returns how many there were; as many as leave
// `spare_bytes` of address space to other things.
int CountStartableThreads(int most, size_t stack_bytes, size_t spare_bytes);

// For a thread that is needed and cannot be started; names the limits.
Error NoThreadError();

}  // namespace hpm
