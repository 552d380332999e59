// SIGINT and SIGTERM ask for a clean stop; a second one ends the program at
// once.
#pragma once

#include "src/base/cancel.h"

namespace hpm {

// Also ignores SIGXFSZ and SIGPIPE, so that a full disk or a closed pipe is an
// error of the write and not the end of the program. Returns the token that the
// handler cancels.
const CancelToken& InstallSignalHandlers();

// The number of the last SIGINT or SIGTERM, 0 if there was none.
int CaughtSignal();

}  // namespace hpm
