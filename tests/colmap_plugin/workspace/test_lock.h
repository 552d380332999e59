// Locks for tests: held in this process, or by a child that is killed.
#pragma once

#include "colmap_plugin/workspace/run_lock.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace hpm {

// Waits of a fraction of a second instead of minutes.
inline LockRules FastRules() {
  LockRules rules;
  rules.heartbeat = std::chrono::milliseconds(20);
  rules.watch = std::chrono::milliseconds(200);
  rules.settle = std::chrono::milliseconds(200);
  return rules;
}

struct TestLock {
  explicit TestLock(const std::filesystem::path& state,
                    const LockRules& rules = FastRules(),
                    const LockShard& shard = {})
      : lock(
            state,
            [this](LogLevel level, const std::string& line) {
              if (level == LogLevel::kWarning) warnings.push_back(line);
            },
            &stop,
            shard,
            rules) {}

  std::vector<std::string> warnings;
  CancelToken stop;
  RunLock lock;
};

// A child process that holds the lock until it is killed.
inline pid_t ForkOwner(const std::filesystem::path& state,
                       const LockRules& rules = FastRules(),
                       const LockShard& shard = {}) {
  int ready[2];
  if (pipe(ready) != 0) return -1;
  const pid_t pid = fork();
  if (pid == 0) {
    try {
      const TestLock lock(state, rules, shard);
      if (write(ready[1], "x", 1) == 1) {
        for (;;) pause();
      }
    } catch (...) {
    }
    _exit(1);
  }
  close(ready[1]);
  char byte;
  const bool holds = read(ready[0], &byte, 1) == 1;
  close(ready[0]);
  return holds ? pid : -1;
}

inline void Kill(pid_t pid) {
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
}

}  // namespace hpm
