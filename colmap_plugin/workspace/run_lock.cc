#include "colmap_plugin/workspace/run_lock.h"

#include "colmap_plugin/workspace/lock_file.h"
#include "colmap_plugin/workspace/lock_owner.h"
#include "src/base/error.h"
#include "src/base/retries.h"
#include "src/base/threads.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <optional>
#include <system_error>
#include <vector>

#include <fmt/format.h>

namespace hpm {
namespace fs = std::filesystem;
namespace {

// A lock that stays unreadable for this long was left by a run that died while
// it wrote these few bytes; an flock that is held for this long is no taker's,
// who looks at the file and lets go.
constexpr int kMaxTries = 10;
constexpr auto kTryInterval = std::chrono::milliseconds(10);
// Lost races against other takers before giving up.
constexpr int kMaxAttempts = 100;

bool IsSameFile(int fd, const fs::path& path) {
  struct stat opened = {};
  struct stat named = {};
  return fstat(fd, &opened) == 0 && lstat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

[[noreturn]] void ThrowSystemError(const fs::path& path, int error) {
  const bool full = error == ENOSPC || error == EDQUOT || error == EFBIG;
  throw Error(full ? ErrorCode::kOutOfResources : ErrorCode::kBadInput,
              fmt::format("cannot write {}: {}; {}",
                          path.string(),
                          std::generic_category().message(error),
                          full                 ? "make room on the disk"
                          : IsTransient(error) ? "check the disk or its server"
                                               : "make the folder writable"));
}

[[noreturn]] void ThrowOthersAreStarting(const fs::path& path) {
  throw Error(ErrorCode::kLocked,
              fmt::format("other runs are starting on this workspace at the "
                          "same time; run again, "
                          "or delete {} if there are none",
                          path.string()));
}

}  // namespace

RunLock::RunLock(const fs::path& state_path,
                 const LogSink& log,
                 CancelToken* stop,
                 const LockShard& shard,
                 const LockRules& rules)
    : path_(state_path / LockFileName(shard)), stop_(stop), rules_(rules) {
  const std::error_code error = MakeFolder(state_path);
  if (error) ThrowSystemError(path_, ErrnoOf(error));
  const LockOwner self = ThisProcess();
  int attempt = 0;
  Retries retries(path_);
  while (!TryCreate(self, &retries)) {
    if (++attempt == kMaxAttempts) ThrowOthersAreStarting(path_);
    RemoveStale(path_, self, log);
  }
  try {
    if (may_have_rivals_) {
      Wait(rules_.settle);
      const auto now = ReadLockFile(path_);
      if (!now || now->contents != contents_) ThrowOthersAreStarting(path_);
    }
    heart_ = std::thread([this] { KeepAlive(); });
    RefuseRivals(shard, self, log);
  } catch (const std::system_error&) {
    EndHeartbeat();
    Release();
    throw NoThreadError();
  } catch (...) {
    EndHeartbeat();
    Release();
    throw;
  }
}

RunLock::~RunLock() {
  EndHeartbeat();
  Release();
}

void RunLock::EndHeartbeat() {
  if (!heart_.joinable()) return;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    ending_ = true;
  }
  wake_.notify_all();
  heart_.join();
}

void RunLock::ThrowIfLost() const {
  const auto now = ReadLockFile(path_);
  // A server that does not answer has not given the lock away.
  if (now ? now->contents == contents_ : errno != ENOENT) return;
  const auto owner = now ? ParseLockOwner(now->contents) : std::nullopt;
  throw Error(
      ErrorCode::kLocked,
      fmt::format(
          "{} is not this run's any more ({}), so it stops; what it finished "
          "stays, give the same command again when no other run is at work",
          path_.string(),
          owner ? "it was taken over by " + NameOf(*owner) : "it was deleted"));
}

bool RunLock::TryCreate(LockOwner self, Retries* retries) {
  fd_ = open(
      path_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666);
  if (fd_ < 0) {
    const int error = errno;
    if (error == EEXIST || retries->Again(error)) return false;
    ThrowSystemError(path_, error);
  }
  if (rules_.is_local(fd_)) {
    int result;
    while ((result = flock(fd_, LOCK_EX)) != 0 && errno == EINTR) {
    }
    self.flock = result == 0;
  }
  self.heartbeat = true;
  contents_ = FormatLockOwner(self);
  const ssize_t n = write(fd_, contents_.data(), contents_.size());
  int error = 0;
  if (n != static_cast<ssize_t>(contents_.size()))
    error = n < 0 ? errno : ENOSPC;
  // For other machines to see.
  if (error == 0 && SyncFile(fd_) != 0 && errno != EINVAL && errno != ENOTSUP)
    error = errno;
  const bool is_named = IsSameFile(fd_, path_);
  if (error == 0 && is_named) return true;
  // Not named: a taker thought the empty file stale.
  if (is_named) unlink(path_.c_str());
  close(fd_);
  fd_ = -1;
  if (error != 0 && !retries->Again(error)) ThrowSystemError(path_, error);
  return false;
}

void RunLock::Release() {
  const auto now = ReadLockFile(path_);
  if (now && now->contents == contents_) unlink(path_.c_str());
  close(fd_);
}

// Removes the lock of a dead process; throws Error(kLocked) if the owner lives.
// Returns without removing anything if the file changed meanwhile: try again.
//
// On a local file system takers exclude each other, and creators that are still
// writing, by flock() on the stale file itself: whoever holds it, still finds
// that very file under the name and reads what he read before may remove it,
// since nobody else removes a file he has not locked. (Owners remove theirs
// only while they live.) Elsewhere two takers may both remove the file, the
// later one the lock that the earlier one has made by then. So a taker waits
// before he starts, longer than an owner needs to notice and stop.
void RunLock::RemoveStale(const fs::path& path,
                          const LockOwner& self,
                          const LogSink& log) {
  const FileDescriptor file(RetryCall(path, [&] { return OpenLock(path); }));
  if (file.get() < 0) {
    if (errno == ENOENT) return;
    ThrowCannotRead(path, errno);
  }
  std::optional<std::string> contents;
  std::optional<LockOwner> owner;
  for (int i = 0; i <= kMaxTries && !owner; ++i) {
    if (i > 0) std::this_thread::sleep_for(kTryInterval);
    contents = ReadLock(file.get());
    if (!contents) ThrowCannotRead(path, errno);
    owner = ParseLockOwner(*contents);
  }
  const bool is_local = rules_.is_local(file.get());
  const bool flock_tells = is_local && owner && owner->flock;
  const bool is_visible = owner && IsVisible(*owner, self);
  const bool heartbeat_tells =
      owner && !flock_tells && !is_visible && owner->heartbeat;
  const auto throw_locked = [&] {
    if (!IsSameFile(file.get(), path)) return;
    ThrowLocked(
        path,
        *owner,
        heartbeat_tells
            ? fmt::format(" (it counts as gone {} seconds after its last sign "
                          "of life)",
                          std::chrono::duration_cast<std::chrono::seconds>(
                              rules_.expiry)
                              .count())
            : "");
  };
  if (owner && !flock_tells) {
    if (is_visible
            ? IsAlive(*owner)
            : !owner->heartbeat || ShowsSignOfLife(path, *contents, log)) {
      return throw_locked();
    }
  }
  if (is_local) {
    Flock taken = TryFlock(file.get());
    for (int i = 0; i < kMaxTries && taken == Flock::kHeldByAnother; ++i) {
      std::this_thread::sleep_for(kTryInterval);
      taken = TryFlock(file.get());
    }
    if (taken == Flock::kHeldByAnother) {
      if (flock_tells) throw_locked();
      return;
    }
    if (taken == Flock::kUnsupported) may_have_rivals_ = true;
  } else {
    may_have_rivals_ = true;
  }
  const auto now = ReadLockFile(path);
  if (!now || now->contents != *contents || !IsSameFile(file.get(), path))
    return;
  if (unlink(path.c_str()) != 0 && errno != ENOENT)
    ThrowSystemError(path, errno);
  if (heartbeat_tells) {
    log(LogLevel::kWarning,
        fmt::format("the lock of another run ({}) is taken over, since that "
                    "run has given no sign of life for minutes",
                    NameOf(*owner)));
  } else if (owner) {
    log(LogLevel::kInfo,
        fmt::format("The lock of a run that is gone ({}) is taken over.",
                    NameOf(*owner)));
  }
}

// Also true if nothing can be told.
bool RunLock::ShowsSignOfLife(const fs::path& path,
                              const std::string& contents,
                              const LogSink& log) const {
  const auto first = ReadLockFile(path);
  const auto clock = FileSystemTime(path.parent_path());
  if (!first || !clock || first->contents != contents) return true;
  const double age = 1e-9 * static_cast<double>(*clock - first->touched);
  const double expiry = std::chrono::duration<double>(rules_.expiry).count();
  // A time in the future is of another clock, and no sign of life either.
  if (std::abs(age) < expiry) return true;
  log(LogLevel::kInfo,
      fmt::format(
          "{} is of a run that seems to be gone; watching it for {:.0f} "
          "seconds...",
          path.string(),
          std::chrono::duration<double>(rules_.watch).count()));
  Wait(rules_.watch);
  const auto last = ReadLockFile(path);
  return !last || last->contents != contents || last->touched != first->touched;
}

// Throws Error(kLocked) if someone is at work who does not go with this run;
// removes what the dead have left.
void RunLock::RefuseRivals(const LockShard& shard,
                           const LockOwner& self,
                           const LogSink& log) {
  std::error_code error;
  for (const fs::path& rival : LocksAgainst(path_.parent_path(), shard)) {
    if (rival == path_) continue;
    for (int i = 0; fs::exists(fs::symlink_status(rival, error)); ++i) {
      if (i == kMaxAttempts) ThrowOthersAreStarting(rival);
      RemoveStale(rival, self, log);
    }
  }
}

void RunLock::Wait(std::chrono::milliseconds time) const {
  constexpr auto kStep = std::chrono::milliseconds(50);
  const auto end = std::chrono::steady_clock::now() + time;
  for (auto now = std::chrono::steady_clock::now(); now < end;
       now = std::chrono::steady_clock::now()) {
    stop_->ThrowIfCancelled();
    std::this_thread::sleep_for(
        std::min<std::chrono::steady_clock::duration>(kStep, end - now));
  }
}

void RunLock::KeepAlive() {
  std::unique_lock<std::mutex> lock(mutex_);
  while (!wake_.wait_for(lock, rules_.heartbeat, [this] { return ending_; })) {
    futimens(fd_, nullptr);  // by the file system's own clock
    try {
      ThrowIfLost();
    } catch (...) {
      stop_->Cancel();  // and whoever stops asks for the reason
      return;
    }
  }
}

namespace {

void ThrowIfHeld(const fs::path& path, const LockRules& rules) {
  const FileDescriptor file(RetryCall(path, [&] { return OpenLock(path); }));
  if (file.get() < 0 && errno == ENOENT) return;
  const std::optional<std::string> contents =
      file.get() < 0 ? std::nullopt : ReadLock(file.get());
  if (!contents) ThrowCannotRead(path, errno);
  const auto owner = ParseLockOwner(*contents);
  if (!owner) return;
  bool is_alive = true;
  if (owner->flock && rules.is_local(file.get())) {
    is_alive = TryFlock(file.get()) == Flock::kHeldByAnother;
  } else if (IsVisible(*owner, ThisProcess())) {
    is_alive = IsAlive(*owner);
  } else if (owner->heartbeat) {
    struct stat status = {};
    const std::chrono::nanoseconds now =
        std::chrono::system_clock::now().time_since_epoch();
    is_alive = fstat(file.get(), &status) != 0 ||
               std::abs(now.count() - ModifiedNanoseconds(status)) <
                   std::chrono::nanoseconds(rules.expiry).count();
  }
  if (is_alive) ThrowLocked(path, *owner, "");
}

}  // namespace

void ThrowIfLocked(const fs::path& state_path,
                   const LockShard& shard,
                   const LockRules& rules) {
  for (const fs::path& path : LocksAgainst(state_path, shard))
    ThrowIfHeld(path, rules);
}

}  // namespace hpm
