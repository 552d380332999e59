#include "colmap_plugin/tool/standard_streams.h"

#include <cerrno>

#include <fcntl.h>
#include <unistd.h>

namespace hpm {

void OpenStandardStreams() {
  for (int fd = STDIN_FILENO; fd <= STDERR_FILENO; ++fd) {
    if (fcntl(fd, F_GETFD) != -1 || errno != EBADF) continue;
    // The lowest free number is given, and that is fd. Where there is no
    // /dev/null a folder holds the number; nothing can be written to it.
    if (open("/dev/null", O_RDWR) < 0) open("/", O_RDONLY);
  }
}

}  // namespace hpm
