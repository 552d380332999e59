#include "colmap_plugin/formats/published_file.h"

#include "src/base/platform/files.h"
#include "src/base/retries.h"

#include <cerrno>

namespace hpm {
namespace {

std::optional<FileState> StateFrom(int result, const struct stat& status) {
  if (result != 0) return std::nullopt;
  return FileState{static_cast<uint64_t>(status.st_size),
                   ModifiedNanoseconds(status)};
}

}  // namespace

std::optional<FileState> StateOf(const std::filesystem::path& path) {
  struct stat status = {};
  const int result =
      RetryCall(path, [&] { return stat(path.c_str(), &status); });
  if (result != 0) ThrowIfTransient(errno, path);
  return StateFrom(result, status);
}

std::optional<FileState> StateOf(int fd) {
  struct stat status = {};
  const int result = fstat(fd, &status);
  return StateFrom(result, status);
}

}  // namespace hpm
