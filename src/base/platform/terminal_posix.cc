#include "src/base/platform/terminal.h"

#include <cerrno>

#include <fcntl.h>
#include <sys/ioctl.h>
#include <unistd.h>

namespace hpm {

bool IsStandardOutputATerminal() { return isatty(STDOUT_FILENO) != 0; }

int TerminalColumns() {
  winsize size = {};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

void OpenStandardStreams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (fcntl(fd, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is given, and that is fd. Where there is no
    // /dev/null a folder holds the number; nothing can be written to it.
    if (open("/dev/null", O_RDWR) < 0) open("/", O_RDONLY);
  }
}

}  // namespace hpm
