#include "src/base/threads.h"

namespace hpm {

Error NoThreadError() {
  return Error(
      ErrorCode::kOutOfResources,
      "cannot start a thread; raise the limit on processes (ulimit -u, or the "
      "container's pids limit) or on address space (ulimit -v), or set a "
      "smaller --PatchMatchStereo.num_threads");
}

}  // namespace hpm
