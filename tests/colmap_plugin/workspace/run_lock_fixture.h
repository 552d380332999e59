// The lock of a workspace, near or far, as a run finds it.
#pragma once

#include "tests/colmap_plugin/workspace/test_lock.h"

#include <ctime>
#include <filesystem>
#include <functional>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>

namespace hpm {

// As on a network file system, where no flock is trusted.
inline LockRules FarRules() {
  LockRules rules = FastRules();
  rules.is_local = [](int) { return false; };
  return rules;
}

// The time of a file's last change, that many seconds ago.
inline void SetAge(const std::filesystem::path& path, int seconds) {
  timespec times[2] = {};
  clock_gettime(CLOCK_REALTIME, &times[0]);
  times[0].tv_sec -= seconds;
  times[1] = times[0];
  ASSERT_EQ(utimensat(AT_FDCWD, path.c_str(), times, 0), 0);
}

class RunLockTest : public ::testing::Test {
 protected:
  std::filesystem::path state() const {
    return folder_.path() / "stereo/hpm_mvs";
  }
  std::filesystem::path lock() const { return state() / "lock"; }

  // The lock this process would write, changed.
  std::string ChangedLock(const std::function<void(nlohmann::json&)>& change) {
    nlohmann::json json;
    {
      const TestLock held(state());
      json = nlohmann::json::parse(ReadFile(lock()));
    }
    change(json);
    return json.dump();
  }

  ScratchFolder folder_;
};

}  // namespace hpm
