#include "src/base/threads.h"

namespace hpm {

// Windows grants what memory allows; nothing to ask before.
int CountStartableThreads(int most, size_t, size_t) { return most; }

}  // namespace hpm
