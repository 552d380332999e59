// The calls on files that C++ has no name for. On POSIX systems they are the
// system's own; on Windows the same names in this namespace do the same there,
// so that callers read alike everywhere.
#pragma once

#include "src/base/platform/errors.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>

#ifdef _WIN32
#include "src/base/platform/files_windows.h"
#else
#include <fcntl.h>
#include <stdio.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>
#endif

namespace hpm {

// What was written to this open file lies on the disk then, not only in the
// cache of the disk. 0 or -1 and errno, as fsync(2).
int SyncFile(int fd);

// From then on `to` is the open file that `from` was, for all threads at once;
// `from` is closed in any case. 0 or -1 and errno.
int MoveDescriptor(int from, int to);

// Whether one kernel alone writes the file system of this open file, so that an
// flock is seen by everybody who could open the file. False where in doubt:
// network file systems, FUSE, clusters, virtual machines' shared folders.
bool IsOnLocalFileSystem(int fd);

// Whether permissions let this process make files in the folder; on a full disk
// and some file systems it cannot all the same.
bool MayWriteInto(const std::filesystem::path& folder);

// Since 1970, as exact as the file system keeps it.
int64_t ModifiedNanoseconds(const struct stat& status);

}  // namespace hpm
