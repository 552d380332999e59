#include "colmap_plugin/formats/atomic_file.h"

#include "src/base/error.h"
#include "src/base/platform/files.h"
#include "src/base/platform/processes.h"
#include "src/base/retries.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <string>
#include <system_error>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

constexpr size_t kMaxHostLength = 64;

// FNV-1a.
uint64_t HashOf(const std::string& text) {
  uint64_t hash = 0xcbf29ce484222325u;
  for (const char c : text)
    hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
  return hash;
}

// ".tmp.<host>.<hash>." : what a temporary of those who know each other by
// process id has before it. The hash is of the running kernel and of the name
// space of process ids: containers and machines may have the same name. The
// host's name is cut so that temporaries stay short on any system.
std::string TemporaryInfix() {
  std::string host = HostName().substr(0, kMaxHostLength);
  if (host.empty()) host = "localhost";
  std::replace(host.begin(), host.end(), '/', '_');
  static const auto machine =
      static_cast<uint32_t>(HashOf(BootId() + " " + ProcessNamespace()));
  return fmt::format(".tmp.{}.{:08x}.", host, machine);
}

std::string FreeSpace(const fs::path& folder) {
  std::error_code error;
  const fs::space_info space = fs::space(folder, error);
  if (error) return "unknown free space";
  return fmt::format("{} bytes free", space.available);
}

fs::path ParentFolder(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// Made from a hash of the file's name, not from the name itself, which
// may be as long as the disk allows. A process that died with the same id left
// the same name, which is then replaced.
fs::path TemporaryBeside(const fs::path& path) {
  return ParentFolder(path) / fmt::format("hpm_{:016x}{}{}",
                                          HashOf(path.filename().string()),
                                          TemporaryInfix(),
                                          ThisProcessId());
}

int OpenTemporary(const fs::path& path) {
  constexpr int kFlags = O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;
  return RetryCall(path, [&] {
    const int fd = open(path.c_str(), kFlags, 0666);
    if (fd >= 0 || errno != EEXIST) return fd;
    // Left by a dead process that had the same id (usual in containers), by an
    // earlier try whose answer was lost, or a planted link.
    unlink(path.c_str());
    return open(path.c_str(), kFlags, 0666);
  });
}

// The process id at the end of the name of a temporary of this host, else 0.
int64_t OwnerOfTemporary(const std::string& name, const std::string& infix) {
  const size_t digits = name.rfind('.') + 1;
  if (digits == 0 || digits < infix.size()) return 0;
  if (name.compare(digits - infix.size(), infix.size(), infix) != 0) return 0;
  int64_t pid = 0;
  const char* end = name.data() + name.size();
  const auto [parsed, error] = std::from_chars(name.data() + digits, end, pid);
  return error == std::errc() && parsed == end && pid > 0 ? pid : 0;
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& path, Durability durability)
    : path_(path), durability_(durability) {
  const std::error_code error = MakeFolder(ParentFolder(path));
  if (error) Throw("create the folder of", ErrnoOf(error));
  const fs::path temporary = TemporaryBeside(path);
  fd_ = OpenTemporary(temporary);
  if (fd_ < 0) Throw("create a temporary file beside", errno);
  temporary_ = temporary;
}

AtomicFile::~AtomicFile() {
  if (fd_ >= 0) close(fd_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::Write(const void* data, size_t num_bytes) {
  WriteAll(data, num_bytes, [this](const char* bytes, size_t count) {
    return write(fd_, bytes, count);
  });
}

void AtomicFile::WriteAt(uint64_t offset, const void* data, size_t num_bytes) {
  WriteAll(data, num_bytes, [&](const char* bytes, size_t count) {
    const auto done = bytes - static_cast<const char*>(data);
    return pwrite(fd_, bytes, count, static_cast<off_t>(offset) + done);
  });
}

// write_some(bytes, count): as write(2).
template <class WriteSome>
void AtomicFile::WriteAll(const void* data,
                          size_t num_bytes,
                          const WriteSome& write_some) {
  const char* bytes = static_cast<const char*>(data);
  while (num_bytes > 0) {
    const ssize_t n = write_some(bytes, num_bytes);
    if (n < 0) {
      if (errno == EINTR) continue;
      ThrowUnwritten(errno);
    }
    bytes += n;
    num_bytes -= static_cast<size_t>(n);
    num_written_ += static_cast<uint64_t>(n);
  }
}

void AtomicFile::Flush() {
  if (durability_ == Durability::kProcess || num_synced_ == num_written_)
    return;
  const uint64_t num_bytes = num_written_;
  int result;
  do {
    result = SyncFile(fd_);
  } while (result != 0 && errno == EINTR);
  if (result != 0) ThrowUnwritten(errno);
  num_synced_ = num_bytes;
}

FileState AtomicFile::Commit() {
  Flush();
  const std::optional<FileState> state = StateOf(fd_);
  if (!state) ThrowUnwritten(errno);
  // Linux closes the descriptor even if close() fails. EINTR is harmless after
  // fsync.
  const int fd = fd_;
  fd_ = -1;
  if (close(fd) != 0 && errno != EINTR) ThrowUnwritten(errno);
  if (!Rename(*state)) Throw("put in place", errno);
  temporary_.clear();
  if (durability_ == Durability::kProcess) return *state;

  SyncFolder();
  return *state;
}

void AtomicFile::SyncFolder() const {
  const fs::path path = ParentFolder(path_);
  bool is_open = false;
  // A stale handle stays so: each try opens the folder anew.
  const int result = RetryCall(path, [&] {
    const int folder = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    is_open = folder >= 0;
    if (!is_open) return -1;
    const int once = SyncFile(folder);
    const int error = errno;
    close(folder);
    errno = error;
    return once;
  });
  // A folder may be written but not listed, and some network file systems
  // cannot sync one: then rename is all there is.
  if (result != 0 && is_open && errno != EINVAL && errno != ENOTSUP)
    Throw("sync the folder of", errno);
}

bool AtomicFile::Rename(const FileState& state) const {
  bool is_first = true;
  const int result = RetryCall(path_, [&] {
    const int once = rename(temporary_.c_str(), path_.c_str());
    // The answer to an earlier try may have been lost.
    const bool was_renamed =
        once != 0 && errno == ENOENT && !is_first && StateOf(path_) == state;
    is_first = false;
    return was_renamed ? 0 : once;
  });
  return result == 0;
}

// The bytes that the kernel took before may be lost, too, so it is not enough
// to try the same call again.
void AtomicFile::ThrowUnwritten(int error) const {
  if (!IsTransient(error)) Throw("write", error);
  throw TransientError(
      error,
      path_,
      fmt::format("cannot write {}: {}; check the disk or its server and run "
                  "again",
                  path_.string(),
                  std::generic_category().message(error)));
}

void AtomicFile::Throw(const char* action, int error) const {
  ErrorCode code = ErrorCode::kFailure;
  std::string remedy = "check the disk and run again";
  switch (error) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      code = ErrorCode::kOutOfResources;
      remedy = fmt::format(
          "{} bytes were written, {}; make room (disk, quota or file size "
          "limit) and run again",
          num_written_.load(),
          FreeSpace(ParentFolder(path_)));
      break;
    case EMFILE:
    case ENFILE:
    case ENOMEM:
      code = ErrorCode::kOutOfResources;
      remedy = "raise the limit (ulimit) and run again";
      break;
    case EACCES:
    case EPERM:
    case EROFS:
      code = ErrorCode::kBadInput;
      remedy = "make the folder writable or work on a copy of the workspace";
      break;
    case ENOENT:
    case ENOTDIR:
    case EEXIST:
    case EISDIR:
    case ELOOP:
    case ENAMETOOLONG:
      code = ErrorCode::kBadInput;
      remedy = "check the path and what already stands there";
      break;
    default:
      break;
  }
  throw Error(code,
              fmt::format("cannot {} {}: {}; {}",
                          action,
                          path_.string(),
                          std::generic_category().message(error),
                          remedy));
}

void WriteFileAtomically(const fs::path& path,
                         std::string_view contents,
                         Durability durability) {
  RetryWriting([&] {
    AtomicFile file(path, durability);
    file.Write(contents);
    file.Commit();
  });
}

void RemoveStaleTemporaries(const fs::path& folder) {
  const std::string infix = TemporaryInfix();
  std::error_code error;
  fs::recursive_directory_iterator it(
      folder, fs::directory_options::skip_permission_denied, error);
  for (const fs::recursive_directory_iterator end; !error && it != end;
       it.increment(error)) {
    std::error_code ignored;
    if (it->symlink_status(ignored).type() != fs::file_type::regular) continue;
    const int64_t owner =
        OwnerOfTemporary(it->path().filename().string(), infix);
    if (owner > 0 && StatusOfProcess(owner).state == ProcessState::kGone)
      fs::remove(it->path(), ignored);
  }
}

}  // namespace hpm
