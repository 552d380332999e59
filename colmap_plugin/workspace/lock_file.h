// The files of locks: their names, what they hold, and errors about them.
#pragma once

#include "src/base/platform/files.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hpm {

struct LockOwner;

// One of the runs that share a workspace.
struct LockShard {
  int index = 0;
  int count = 1;  // 1: all of the workspace
};

std::string LockFileName(const LockShard& shard);

// The locks in the folder that exclude one of the shard: its own, and all that
// do not go with it.
std::vector<std::filesystem::path> LocksAgainst(
    const std::filesystem::path& folder, const LockShard& shard);

class FileDescriptor {
 public:
  explicit FileDescriptor(int fd) : fd_(fd) {}
  ~FileDescriptor() {
    if (fd_ >= 0) close(fd_);
  }
  FileDescriptor(const FileDescriptor&) = delete;
  FileDescriptor& operator=(const FileDescriptor&) = delete;
  int get() const { return fd_; }

 private:
  int fd_;
};

// As open() does; follows no link.
int OpenLock(const std::filesystem::path& path);

// Nothing if it cannot be read.
std::optional<std::string> ReadLock(int fd);

// What stands under the name now: network file systems ask their server when a
// file is opened and may show what they remember otherwise.
struct LockFile {
  std::string contents;
  int64_t touched = 0;  // nanoseconds since 1970
};

// Nothing, and errno, if it cannot be read.
std::optional<LockFile> ReadLockFile(const std::filesystem::path& path);

enum class Flock { kTaken, kHeldByAnother, kUnsupported };
Flock TryFlock(int fd);

// For people.
std::string NameOf(const LockOwner& owner);

// error: of the system. Error(kBadInput).
[[noreturn]] void ThrowCannotRead(const std::filesystem::path& path, int error);

// hint: how a run that is gone is found out, else that is up to the user.
// Error(kLocked).
[[noreturn]] void ThrowLocked(const std::filesystem::path& path,
                              const LockOwner& owner,
                              const std::string& hint);

}  // namespace hpm
