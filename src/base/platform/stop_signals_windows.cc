#include "src/base/platform/stop_signals.h"

#include <csignal>

#include <windows.h>

namespace hpm {
namespace {

void (*stop_handler)(int) = nullptr;

BOOL WINAPI HandleEvent(DWORD event) {
  stop_handler(event == CTRL_C_EVENT ? SIGINT : SIGTERM);
  // The system ends the program when the handler of these returns, and after
  // some seconds anyway; what is done by then is kept.
  if (event != CTRL_C_EVENT && event != CTRL_BREAK_EVENT) Sleep(INFINITE);
  return TRUE;
}

}  // namespace

void CatchStopSignals(void (*handler)(int)) {
  stop_handler = handler;
  SetConsoleCtrlHandler(HandleEvent, TRUE);
}

// Windows has no such signals.
void LetWritesFail() {}

}  // namespace hpm
