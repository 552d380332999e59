#include "src/base/platform/terminal.h"

#include <cstdio>

#include <io.h>
#include <windows.h>

namespace hpm {

bool IsStandardOutputATerminal() { return _isatty(_fileno(stdout)) != 0; }

int TerminalColumns() {
  CONSOLE_SCREEN_BUFFER_INFO info = {};
  const HANDLE console = GetStdHandle(STD_OUTPUT_HANDLE);
  if (!GetConsoleScreenBufferInfo(console, &info)) return 0;
  return info.srWindow.Right - info.srWindow.Left + 1;
}

// The C library there gives the numbers 0 to 2 to nothing else.
void OpenStandardStreams() {}

}  // namespace hpm
