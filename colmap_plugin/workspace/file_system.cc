#include "colmap_plugin/workspace/file_system.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "src/base/error.h"
#include "src/base/platform/files.h"
#include "src/base/platform/processes.h"

namespace hpm {

std::optional<int64_t> FileSystemTime(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "clock";
  // Only what has reached a server is stamped by it.
  try {
    WriteFileAtomically(file, "x");
  } catch (const Error&) {
    return std::nullopt;
  }
  struct stat status = {};
  const bool known = stat(file.c_str(), &status) == 0;
  unlink(file.c_str());
  if (!known) return std::nullopt;
  return ModifiedNanoseconds(status);
}

std::string UnsyncedSince(const std::filesystem::path& folder) {
  const int fd = open(folder.c_str(), O_RDONLY | O_CLOEXEC);
  if (fd < 0) return "";
  const bool is_local = IsOnLocalFileSystem(fd);
  close(fd);
  return is_local ? BootId() : "";
}

}  // namespace hpm
