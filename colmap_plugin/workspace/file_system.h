// What the lock has to know of the file system it lies on.
#pragma once

#include <filesystem>
#include <optional>

#include <time.h>

namespace hpm {

// Whether one kernel alone writes the file system of this open file, so that an
// flock is seen by everybody who could open the file. False where in doubt:
// network file systems, FUSE, clusters, virtual machines' shared folders.
bool IsOnLocalFileSystem(int fd);

// The present time by the clock that stamps the files of this folder: that of
// the server on network file systems. Nothing if no file can be written there.
std::optional<timespec> FileSystemTime(const std::filesystem::path& folder);

}  // namespace hpm
