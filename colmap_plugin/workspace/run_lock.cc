#include "colmap_plugin/workspace/run_lock.h"

#include "colmap_plugin/formats/image_name.h"
#include "src/base/error.h"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <thread>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

// A lock that stays unreadable for this long was left by a run that died while
// it wrote these few bytes.
constexpr int kMaxReads = 10;
constexpr auto kReadInterval = std::chrono::milliseconds(10);
// Lost races against other takers before giving up.
constexpr int kMaxAttempts = 100;
constexpr size_t kMaxLockBytes = 4096;

struct LockOwner {
  std::string host;
  std::string pid_namespace;  // "" where unknown
  int64_t pid = 0;
  uint64_t start_time = 0;  // clock ticks since boot, 0 where unknown
};

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

struct ProcessStatus {
  char state = '?';
  uint64_t start_time = 0;
};

// proc(5), /proc/<pid>/stat: fields 3 and 22, counted from behind the command
// name.
std::optional<ProcessStatus> ReadProcessStatus(int64_t pid) {
  std::ifstream file(fmt::format("/proc/{}/stat", pid));
  const std::string text{std::istreambuf_iterator<char>(file),
                         std::istreambuf_iterator<char>()};
  const size_t name_end = text.rfind(')');
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(text.substr(name_end + 1));
  fields.imbue(std::locale::classic());
  ProcessStatus status;
  fields >> status.state;
  std::string skipped;
  for (int field = 4; field < 22; ++field) fields >> skipped;
  fields >> status.start_time;
  if (!fields) return std::nullopt;
  return status;
}

LockOwner ThisProcess() {
  LockOwner owner;
  char host[256] = {};
  if (gethostname(host, sizeof(host) - 1) == 0) owner.host = host;
  std::error_code error;
  owner.pid_namespace = fs::read_symlink("/proc/self/ns/pid", error).string();
  owner.pid = getpid();
  if (const auto status = ReadProcessStatus(owner.pid))
    owner.start_time = status->start_time;
  return owner;
}

std::string Format(const LockOwner& owner) {
  const nlohmann::json json = {{"host", owner.host},
                               {"pid_namespace", owner.pid_namespace},
                               {"pid", owner.pid},
                               {"start_time", owner.start_time}};
  return json.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::optional<LockOwner> Parse(const std::string& text) {
  const nlohmann::json json =
      nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  const auto has = [&](const char* key,
                       bool (nlohmann::json::*is)() const noexcept) {
    return json.contains(key) && (json[key].*is)();
  };
  if (!json.is_object() || !has("host", &nlohmann::json::is_string) ||
      !has("pid_namespace", &nlohmann::json::is_string) ||
      !has("pid", &nlohmann::json::is_number_unsigned) ||
      !has("start_time", &nlohmann::json::is_number_unsigned)) {
    return std::nullopt;
  }
  LockOwner owner;
  owner.host = json["host"];
  owner.pid_namespace = json["pid_namespace"];
  owner.pid = json["pid"];
  owner.start_time = json["start_time"];
  if (owner.pid <= 0 || owner.pid != static_cast<pid_t>(owner.pid))
    return std::nullopt;
  return owner;
}

std::string ReadAll(int fd) {
  std::string text(kMaxLockBytes, '\0');
  const ssize_t n = pread(fd, text.data(), text.size(), 0);
  text.resize(n > 0 ? static_cast<size_t>(n) : 0);
  return text;
}

bool IsAlive(const LockOwner& owner) {
  if (kill(static_cast<pid_t>(owner.pid), 0) != 0 && errno == ESRCH)
    return false;
  const auto status = ReadProcessStatus(owner.pid);
  if (!status) return true;
  if (status->state == 'Z' || status->state == 'X')
    return false;  // dead, not yet waited for
  return owner.start_time == 0 || owner.start_time == status->start_time;
}

bool IsSameFile(int fd, const fs::path& path) {
  struct stat opened = {};
  struct stat named = {};
  return fstat(fd, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

[[noreturn]] void ThrowSystemError(const fs::path& path, int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  throw Error(
      full ? ErrorCode::kOutOfResources : ErrorCode::kBadInput,
      fmt::format("cannot write {}: {}; {}",
                  path.string(),
                  std::generic_category().message(error),
                  full ? "make room on the disk" : "make the folder writable"));
}

[[noreturn]] void ThrowLocked(const fs::path& path, const LockOwner& owner) {
  throw Error(ErrorCode::kLocked,
              fmt::format("another run (host {}, process {}) works on this "
                          "workspace; wait for it, "
                          "or delete {} if that run is gone",
                          QuotedName(owner.host),
                          owner.pid,
                          path.string()));
}

// Removes the lock of a dead process; throws Error(kLocked) if the owner lives.
// Returns without removing anything if the file changed meanwhile: try again.
//
// Takers exclude each other, and creators that are still writing, by flock() on
// the stale file itself: whoever holds it, still finds that very file under the
// name and reads what he read before may remove it, since nobody else removes a
// file he has not locked. (Owners remove theirs only while they live.)
void RemoveStaleLock(const fs::path& path, const LockOwner& self) {
  const FileDescriptor file(
      open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() < 0) {
    if (errno == ENOENT) return;
    ThrowSystemError(path, errno);
  }
  std::string contents = ReadAll(file.get());
  std::optional<LockOwner> owner = Parse(contents);
  for (int i = 0; !owner && i < kMaxReads; ++i) {
    std::this_thread::sleep_for(kReadInterval);
    contents = ReadAll(file.get());
    owner = Parse(contents);
  }
  if (owner) {
    const bool visible =
        owner->host == self.host && owner->pid_namespace == self.pid_namespace;
    if (!visible || IsAlive(*owner)) {
      if (IsSameFile(file.get(), path)) ThrowLocked(path, *owner);
      return;
    }
  }
  if (flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    if (errno == EWOULDBLOCK) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
      return;
    }
    throw Error(
        ErrorCode::kLocked,
        fmt::format(
            "{} was left by a run that is gone; delete it and run again",
            path.string()));
  }
  if (!IsSameFile(file.get(), path) || ReadAll(file.get()) != contents) return;
  if (unlink(path.c_str()) != 0 && errno != ENOENT)
    ThrowSystemError(path, errno);
}

}  // namespace

RunLock::RunLock(const fs::path& state_path) : path_(state_path / "lock") {
  std::error_code error;
  fs::create_directories(state_path, error);
  if (error) ThrowSystemError(path_, error.value());
  const LockOwner self = ThisProcess();
  contents_ = Format(self);
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    if (TryCreate()) return;
    RemoveStaleLock(path_, self);
  }
  throw Error(ErrorCode::kLocked,
              fmt::format("other runs are starting on this workspace at the "
                          "same time; run again, "
                          "or delete {} if there are none",
                          path_.string()));
}

RunLock::~RunLock() {
  // After a takeover by hand (file deleted, other run started) it is not ours.
  const FileDescriptor file(
      open(path_.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
  if (file.get() >= 0 && ReadAll(file.get()) == contents_)
    unlink(path_.c_str());
}

bool RunLock::TryCreate() {
  const FileDescriptor file(
      open(path_.c_str(),
           O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC,
           0666));
  if (file.get() < 0) {
    if (errno == EEXIST) return false;
    ThrowSystemError(path_, errno);
  }
  // Fails where there is no flock; takers give up there, too.
  while (flock(file.get(), LOCK_EX) != 0 && errno == EINTR) {
  }
  const ssize_t n = write(file.get(), contents_.data(), contents_.size());
  if (n != static_cast<ssize_t>(contents_.size())) {
    const int error = n < 0 ? errno : ENOSPC;
    if (IsSameFile(file.get(), path_)) unlink(path_.c_str());
    ThrowSystemError(path_, error);
  }
  return IsSameFile(file.get(),
                    path_);  // else a taker thought the empty file stale
}

}  // namespace hpm
