#include "src/base/threads.h"

#include "src/base/remedies.h"

#include <string>

namespace hpm {

Error NoThreadError() {
  return Error(
      ErrorCode::kOutOfResources,
      std::string("cannot start a thread; raise the limit on processes (ulimit "
                  "-u, or the "
                  "container's pids limit) or on address space (ulimit -v), or "
                  "use ") +
          kFewerThreads);
}

}  // namespace hpm
