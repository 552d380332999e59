#include "colmap_plugin/tool/signals.h"

#include <csignal>

#include <unistd.h>

namespace hpm {
namespace {

CancelToken cancel_token;
volatile std::sig_atomic_t caught_signal = 0;

void HandleSignal(int signal) {
  if (caught_signal != 0) _exit(128 + signal);
  caught_signal = signal;
  cancel_token.Cancel();
}

}  // namespace

const CancelToken& InstallSignalHandlers() {
  struct sigaction action = {};
  sigemptyset(&action.sa_mask);
  action.sa_flags = SA_RESTART;
  action.sa_handler = HandleSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  struct sigaction hangup = {};
  sigaction(SIGHUP, nullptr, &hangup);
  if (hangup.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
  action.sa_handler = SIG_IGN;
  sigaction(SIGXFSZ, &action, nullptr);
  sigaction(SIGPIPE, &action, nullptr);
  return cancel_token;
}

int CaughtSignal() { return caught_signal; }

}  // namespace hpm
