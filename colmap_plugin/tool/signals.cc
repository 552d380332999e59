#include "colmap_plugin/tool/signals.h"

#include "src/base/platform/stop_signals.h"

#include <csignal>
#include <cstdlib>

namespace hpm {
namespace {

CancelToken cancel_token;
volatile std::sig_atomic_t caught_signal = 0;

void HandleSignal(int signal) {
  if (caught_signal != 0) std::_Exit(128 + signal);
  caught_signal = signal;
  cancel_token.Cancel();
}

}  // namespace

const CancelToken& InstallSignalHandlers() {
  CatchStopSignals(HandleSignal);
  LetWritesFail();
  return cancel_token;
}

int CaughtSignal() { return caught_signal; }

}  // namespace hpm
