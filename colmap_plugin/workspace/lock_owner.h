// Who holds a lock: what the lock file says, and whether that process lives.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace hpm {

struct LockOwner {
  std::string host;
  std::string boot_id;        // of the running kernel; "" where unknown
  std::string pid_namespace;  // "" where unknown
  int64_t pid = 0;
  uint64_t start_time = 0;  // clock ticks since boot, 0 where unknown
  std::string job;          // of a batch system, "" where there is none
  std::string token;        // random, so that no two locks have the same bytes
  bool flock = false;       // it holds an flock on the file while it lives
  bool heartbeat = false;   // it touches the file while it lives
};

LockOwner ThisProcess();

// One line of JSON.
std::string FormatLockOwner(const LockOwner& owner);

// Nothing if the text is no complete lock. Locks of versions that knew neither
// boot_id, token, flock nor heartbeat are read.
std::optional<LockOwner> ParseLockOwner(const std::string& text);

// Whether `self` can see the owner's process: same machine, same name space.
bool IsVisible(const LockOwner& owner, const LockOwner& self);

// For an owner that is visible. The start time tells a reused id apart.
bool IsAlive(const LockOwner& owner);

}  // namespace hpm
