// SIGINT, SIGTERM and SIGHUP ask for a clean stop; a second one ends the
// program at once.
#pragma once

#include "src/base/cancel.h"

namespace hpm {

// A SIGHUP that is ignored stays so (nohup). Also ignores SIGXFSZ and SIGPIPE,
// so that a full disk or a closed pipe is an error of the write and not the end
// of the program. Returns the token that the handler cancels.
const CancelToken& InstallSignalHandlers();

// The number of the last of these signals, 0 if there was none.
int CaughtSignal();

}  // namespace hpm
