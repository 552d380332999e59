#include "colmap_plugin/workspace/lock_file.h"

#include "colmap_plugin/formats/image_name.h"
#include "colmap_plugin/workspace/lock_owner.h"
#include "src/base/error.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxLockBytes = 4096;
constexpr const char* kLockName = "lock";

// Whether a lock of this name goes with that of the shard.
bool GoesWith(const std::string& name, const LockShard& shard) {
  const std::string suffix = fmt::format("-of-{}", shard.count);
  return shard.count > 1 && name.size() > suffix.size() &&
         name.compare(name.size() - suffix.size(), suffix.size(), suffix) == 0;
}

}  // namespace

std::string LockFileName(const LockShard& shard) {
  if (shard.count <= 1) return kLockName;
  return fmt::format("{}.{}-of-{}", kLockName, shard.index, shard.count);
}

std::vector<fs::path> LocksAgainst(const fs::path& folder,
                                   const LockShard& shard) {
  std::vector<fs::path> locks;
  std::error_code error;
  for (fs::directory_iterator it(folder, error), end; !error && it != end;
       it.increment(error)) {
    const std::string name = it->path().filename().string();
    const bool is_lock =
        name == kLockName || name.rfind(std::string(kLockName) + ".", 0) == 0;
    if (is_lock && (name == LockFileName(shard) || !GoesWith(name, shard)))
      locks.push_back(it->path());
  }
  return locks;
}

int OpenLock(const fs::path& path) {
  return open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
}

std::optional<std::string> ReadLock(int fd) {
  std::string text(kMaxLockBytes, '\0');
  ssize_t n;
  do {
    n = pread(fd, text.data(), text.size(), 0);
  } while (n < 0 && errno == EINTR);
  if (n < 0) return std::nullopt;
  text.resize(static_cast<size_t>(n));
  return text;
}

std::optional<LockFile> ReadLockFile(const fs::path& path) {
  const FileDescriptor file(OpenLock(path));
  if (file.get() < 0) return std::nullopt;
  struct stat status = {};
  const std::optional<std::string> contents = ReadLock(file.get());
  if (!contents || fstat(file.get(), &status) != 0) {
    errno = EIO;
    return std::nullopt;
  }
  return LockFile{*contents, ModifiedNanoseconds(status)};
}

Flock TryFlock(int fd) {
  if (flock(fd, LOCK_EX | LOCK_NB) == 0) return Flock::kTaken;
  return errno == EWOULDBLOCK ? Flock::kHeldByAnother : Flock::kUnsupported;
}

std::string NameOf(const LockOwner& owner) {
  return fmt::format("host {}, process {}{}",
                     QuotedName(owner.host),
                     owner.pid,
                     owner.job.empty() ? "" : ", job " + QuotedName(owner.job));
}

void ThrowCannotRead(const fs::path& path, int error) {
  throw Error(
      ErrorCode::kBadInput,
      fmt::format("cannot read {}: {}; make it readable, or delete it if no "
                  "other run works on this workspace",
                  path.string(),
                  std::generic_category().message(error)));
}

void ThrowLocked(const fs::path& path,
                 const LockOwner& owner,
                 const std::string& hint) {
  throw Error(ErrorCode::kLocked,
              fmt::format("another run ({}) works on this workspace; wait for "
                          "it{}, or delete {} if that run is gone",
                          NameOf(owner),
                          hint,
                          path.string()));
}

}  // namespace hpm
