// Who works on a workspace: one run on all of it (stereo/hpm_mvs/lock), or runs
// on its shards, one on each (lock.0-of-3 and so on), all of the same division.
#pragma once

#include "colmap_plugin/workspace/file_system.h"
#include "colmap_plugin/workspace/lock_file.h"
#include "src/base/cancel.h"
#include "src/base/log.h"
#include "src/base/platform/files.h"

#include <chrono>
#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <string>
#include <thread>

namespace hpm {

struct LockOwner;
class Retries;

struct LockRules {
  // The owner touches its lock this often and looks whether it still is its.
  std::chrono::milliseconds heartbeat = std::chrono::seconds(5);
  // Without a touch for so long the owner is suspected to be dead ...
  std::chrono::milliseconds expiry = std::chrono::minutes(5);
  // ... and after several heartbeats more it is believed, whatever the clocks.
  std::chrono::milliseconds watch = std::chrono::seconds(15);
  // A taker that is not sure to be alone starts when everybody else who lost
  // the lock has had a heartbeat and time to stop.
  std::chrono::milliseconds settle = std::chrono::seconds(10);
  bool (*is_local)(int fd) = IsOnLocalFileSystem;
};

// The file is created with O_EXCL and names the owner (lock_owner.h). Of
// several takers of a lock exactly one wins. Whether an owner is dead is told
// - on a local file system by the flock that it holds on the file: from every
//   container of the machine, whatever its host name;
// - else, of a process of this machine and process id name space, by asking the
//   kernel for it;
// - else by its heartbeat, the time of the file against the clock of the file
//   system. An owner that was stopped so long may wake: it notices (see stop,
//   ThrowIfLost) and ends.
// Who has made his file looks for those that exclude it; so of two who do not
// go together one sees the other, whoever was first.
class RunLock {
 public:
  // Throws Error(kLocked) naming host, process and remedy if another run (or
  // another RunLock of this process) holds the lock; Error(kBadInput,
  // kOutOfResources) if the file cannot be written; Error(kInterrupted) when
  // `stop` was cancelled while it waits. `stop` is cancelled when the lock is
  // lost.
  RunLock(const std::filesystem::path& state_path,
          const LogSink& log,
          CancelToken* stop,
          const LockShard& shard = {},
          const LockRules& rules = {});
  ~RunLock();  // removes the file if it is still this lock's
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  const std::filesystem::path& path() const { return path_; }

  // Throws Error(kLocked) if the file is gone or another's. To be asked before
  // anything is published.
  void ThrowIfLost() const;

 private:
  // False: try again.
  bool TryCreate(LockOwner self, Retries* retries);
  void RemoveStale(const std::filesystem::path& path,
                   const LockOwner& self,
                   const LogSink& log);
  bool ShowsSignOfLife(const std::filesystem::path& path,
                       const std::string& contents,
                       const LogSink& log) const;
  void RefuseRivals(const LockShard& shard,
                    const LockOwner& self,
                    const LogSink& log);
  void Wait(std::chrono::milliseconds time) const;
  void KeepAlive();
  void EndHeartbeat();
  void Release();

  std::filesystem::path path_;
  CancelToken* stop_;
  const LockRules rules_;
  std::string contents_;
  int fd_ = -1;  // of the file, open and locked as long as it is held
  bool may_have_rivals_ = false;

  std::mutex mutex_;
  std::condition_variable wake_;
  bool ending_ = false;
  std::thread heart_;
};

// Throws Error(kLocked) if a run is at work that excludes one on the shard, as
// far as can be told at once and without changing anything, Error(kBadInput) if
// the lock cannot be read.
void ThrowIfLocked(const std::filesystem::path& state_path,
                   const LockShard& shard = {},
                   const LockRules& rules = {});

}  // namespace hpm
