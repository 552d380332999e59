#include "colmap_plugin/workspace/run_lock.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <csignal>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/wait.h>
#include <unistd.h>

namespace hpm {
namespace {

using testing::HasSubstr;

// A child process that holds the lock until it is killed.
pid_t ForkOwner(const std::filesystem::path& state) {
  int ready[2];
  if (pipe(ready) != 0) return -1;
  const pid_t pid = fork();
  if (pid == 0) {
    try {
      const RunLock lock(state);
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

void Kill(pid_t pid) {
  kill(pid, SIGKILL);
  waitpid(pid, nullptr, 0);
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
      const RunLock held(state());
      json = nlohmann::json::parse(ReadFile(lock()));
    }
    change(json);
    return json.dump();
  }

  ScratchFolder folder_;
};

TEST_F(RunLockTest, IsThereWhileHeldAndGoneAfterwards) {
  {
    const RunLock held(state());
    EXPECT_TRUE(std::filesystem::exists(lock()));
  }
  EXPECT_FALSE(std::filesystem::exists(lock()));
}

TEST_F(RunLockTest, ASecondRunIsToldWhoHoldsIt) {
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  const auto error = ErrorOf([&] { RunLock second(state()); });
  Kill(owner);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kLocked);
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  EXPECT_THAT(error->what(), HasSubstr(host));
  EXPECT_THAT(error->what(), HasSubstr(std::to_string(owner)));
  EXPECT_THAT(error->what(), HasSubstr(lock().string()));
}

TEST_F(RunLockTest, ASecondLockOfTheSameProcessIsRefused) {
  const RunLock first(state());
  const auto error = ErrorOf([&] { RunLock second(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kLocked);
  EXPECT_TRUE(std::filesystem::exists(lock()));
}

TEST_F(RunLockTest, TheLockOfAKilledProcessIsTakenOver) {
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  Kill(owner);
  ASSERT_TRUE(std::filesystem::exists(lock()));
  const RunLock second(state());
  EXPECT_THAT(ReadFile(lock()), HasSubstr(std::to_string(getpid())));
}

TEST_F(RunLockTest, AKilledProcessThatNobodyWaitedForIsDead) {
  if (!std::filesystem::exists("/proc/self/stat"))
    GTEST_SKIP() << "needs /proc";
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  kill(owner, SIGKILL);
  siginfo_t info;
  waitid(P_PID, static_cast<id_t>(owner), &info, WEXITED | WNOWAIT);
  EXPECT_FALSE(ErrorOf([&] { RunLock second(state()); }));
  waitpid(owner, nullptr, 0);
}

TEST_F(RunLockTest, AReusedProcessIdIsToldApartByItsStartTime) {
  if (!std::filesystem::exists("/proc/self/stat"))
    GTEST_SKIP() << "needs /proc";
  const std::string other = ChangedLock([](nlohmann::json& json) {
    json["start_time"] = json["start_time"].get<uint64_t>() - 1;
  });
  WriteFile(lock(), other);
  EXPECT_FALSE(ErrorOf([&] { RunLock second(state()); }));
}

TEST_F(RunLockTest, OtherHostsAndContainersAreNeverTakenOver) {
  for (const char* key : {"host", "pid_namespace"}) {
    const std::string foreign = ChangedLock([&](nlohmann::json& json) {
      json[key] = "elsewhere";
      json["start_time"] = 1;
    });
    WriteFile(lock(), foreign);
    const auto error = ErrorOf([&] { RunLock second(state()); });
    ASSERT_TRUE(error) << key;
    EXPECT_EQ(error->code(), ErrorCode::kLocked);
    EXPECT_EQ(ReadFile(lock()), foreign);
    std::filesystem::remove(lock());
  }
}

TEST_F(RunLockTest, DamagedLocksAreTakenOver) {
  std::filesystem::create_directories(state());
  for (const std::string& text :
       {std::string(),
        std::string("{\"host\":"),
        std::string("{\"host\":\"a\",\"pid_namespace\":\"\",\"pid\":0,"
                    "\"start_time\":0}"),
        std::string(100000, '[')}) {
    WriteFile(lock(), text);
    EXPECT_FALSE(ErrorOf([&] { RunLock second(state()); }))
        << text.substr(0, 50);
    EXPECT_FALSE(std::filesystem::exists(lock()));
  }
}

TEST_F(RunLockTest, MessagesShowNoControlCharacters) {
  WriteFile(lock(), ChangedLock([](nlohmann::json& json) {
              json["host"] = "a\x1b[2J\nb";
            }));
  const auto error = ErrorOf([&] { RunLock second(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(std::string(error->what()).find_first_of("\x1b\n"),
            std::string::npos);
}

TEST_F(RunLockTest, OnlyTheOwnLockIsRemoved) {
  {
    const RunLock held(state());
    WriteFile(lock(), "another run");
  }
  EXPECT_EQ(ReadFile(lock()), "another run");
}

TEST_F(RunLockTest, LinksAreNotFollowed) {
  std::filesystem::create_directories(state());
  const auto canary = folder_.path() / "canary";
  std::filesystem::create_symlink(canary, lock());
  const auto error = ErrorOf([&] { RunLock held(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_FALSE(std::filesystem::exists(canary));
}

TEST_F(RunLockTest, AFolderThatCannotBeMadeIsNamed) {
  WriteFile(folder_.path() / "stereo", "a file");
  const auto error = ErrorOf([&] { RunLock held(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr(state().string()));
}

// Takers that race for a stale lock: inside the lock each creates a file that
// must not be there yet.
TEST_F(RunLockTest, OneOfManyTakersIsInside) {
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  Kill(owner);
  const std::string stale = ReadFile(lock());
  const std::string inside = (folder_.path() / "inside").string();
  constexpr int kNumRounds = 20, kNumTakers = 8;
  for (int round = 0; round < kNumRounds; ++round) {
    WriteFile(lock(), stale);
    std::vector<pid_t> takers;
    for (int i = 0; i < kNumTakers; ++i) {
      const pid_t pid = fork();
      if (pid == 0) {
        int result = 1;
        try {
          const RunLock lock(state());
          const int fd = open(inside.c_str(), O_CREAT | O_EXCL, 0600);
          result = fd < 0 ? 2 : 0;
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
          if (fd >= 0) unlink(inside.c_str());
        } catch (const Error& error) {
          result = error.code() == ErrorCode::kLocked ? 1 : 3;
        } catch (...) {
          result = 3;
        }
        _exit(result);
      }
      takers.push_back(pid);
    }
    int num_inside = 0;
    for (const pid_t pid : takers) {
      int status = 0;
      ASSERT_EQ(waitpid(pid, &status, 0), pid);
      ASSERT_TRUE(WIFEXITED(status));
      ASSERT_LE(WEXITSTATUS(status), 1)
          << "two inside (2) or another error (3)";
      num_inside += WEXITSTATUS(status) == 0;
    }
    EXPECT_GE(num_inside, 1);
    EXPECT_FALSE(std::filesystem::exists(lock()));
  }
}

}  // namespace
}  // namespace hpm
