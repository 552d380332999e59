#include "colmap_plugin/workspace/run_lock.h"

#include "tests/colmap_plugin/workspace/run_lock_fixture.h"

#include <csignal>
#include <ctime>
#include <thread>

#include <fcntl.h>
#include <nlohmann/json.hpp>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hpm {
namespace {

using testing::HasSubstr;

TEST_F(RunLockTest, IsThereWhileHeldAndGoneAfterwards) {
  {
    const TestLock held(state());
    EXPECT_TRUE(std::filesystem::exists(lock()));
  }
  EXPECT_FALSE(std::filesystem::exists(lock()));
}

TEST_F(RunLockTest, ASecondRunIsToldWhoHoldsIt) {
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  const auto error = ErrorOf([&] { TestLock second(state()); });
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
  const TestLock first(state());
  const auto error = ErrorOf([&] { TestLock second(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kLocked);
  EXPECT_TRUE(std::filesystem::exists(lock()));
}

TEST_F(RunLockTest, TheLockOfAKilledProcessIsTakenOver) {
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  Kill(owner);
  ASSERT_TRUE(std::filesystem::exists(lock()));
  const TestLock second(state());
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
  EXPECT_FALSE(ErrorOf([&] { TestLock second(state()); }));
  waitpid(owner, nullptr, 0);
}

TEST_F(RunLockTest, AReusedProcessIdIsToldApartByItsStartTime) {
  if (!std::filesystem::exists("/proc/self/stat"))
    GTEST_SKIP() << "needs /proc";
  const std::string other = ChangedLock([](nlohmann::json& json) {
    json["start_time"] = json["start_time"].get<uint64_t>() - 1;
  });
  for (const LockRules& rules : {FastRules(), FarRules()}) {
    WriteFile(lock(), other);
    EXPECT_FALSE(ErrorOf([&] { TestLock second(state(), rules); }));
  }
}

TEST_F(RunLockTest, AKilledContainersLockIsTakenOverOnTheSameMachine) {
  for (const char* key : {"host", "pid_namespace", "boot_id"}) {
    WriteFile(lock(), ChangedLock([&](nlohmann::json& json) {
                json[key] = "elsewhere";
                json["pid"] = 1;
              }));
    EXPECT_FALSE(ErrorOf([&] { TestLock second(state()); })) << key;
    EXPECT_FALSE(std::filesystem::exists(lock()));
  }
}

TEST_F(RunLockTest, AnOwnerInAnotherContainerIsSeenByItsFlock) {
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  auto json = nlohmann::json::parse(ReadFile(lock()));
  json["host"] = "box-a1";
  json["pid_namespace"] = "pid:[1]";
  json["pid"] = 4194304;  // beyond all process ids
  // Into the same file, which the owner keeps locked. That it is not its lock
  // any more is found at the next heartbeat, but here nobody asks.
  std::ofstream(lock(), std::ios::trunc) << json.dump();
  SetAge(lock(), 100000);
  const auto error = ErrorOf([&] { TestLock second(state()); });
  Kill(owner);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kLocked);
  EXPECT_THAT(error->what(), HasSubstr("box-a1"));
}

// Versions of the program that hold no flock and have no heartbeat.
TEST_F(RunLockTest, OlderLocksOfOthersAreNeverTakenOver) {
  for (const char* key : {"host", "pid_namespace"}) {
    const std::string foreign = ChangedLock([&](nlohmann::json& json) {
      for (const char* added : {"boot_id", "token", "flock", "heartbeat"})
        json.erase(added);
      json[key] = "elsewhere";
      json["start_time"] = 1;
    });
    for (const LockRules& rules : {FastRules(), FarRules()}) {
      WriteFile(lock(), foreign);
      SetAge(lock(), 100000);
      const auto error = ErrorOf([&] { TestLock second(state(), rules); });
      ASSERT_TRUE(error) << key;
      EXPECT_EQ(error->code(), ErrorCode::kLocked);
      EXPECT_EQ(ReadFile(lock()), foreign);
    }
    std::filesystem::remove(lock());
  }
}

TEST_F(RunLockTest, LookingTellsWhoIsAtWorkAndChangesNothing) {
  EXPECT_NO_THROW(ThrowIfLocked(state()));
  EXPECT_EQ(folder_.CountFiles(), 0u);
  for (const LockRules& rules : {FastRules(), FarRules()}) {
    const pid_t owner = ForkOwner(state(), rules);
    ASSERT_GT(owner, 0);
    const std::string contents = ReadFile(lock());
    const auto error = ErrorOf([&] { ThrowIfLocked(state(), {}, rules); });
    Kill(owner);
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kLocked);
    EXPECT_THAT(error->what(), HasSubstr(std::to_string(owner)));
    EXPECT_NO_THROW(ThrowIfLocked(state(), {}, rules));
    EXPECT_EQ(ReadFile(lock()), contents);
  }
}

TEST_F(RunLockTest, TheLockIsTouchedWhileItIsHeld) {
  const TestLock held(state());
  SetAge(lock(), 1000);
  struct stat status = {};
  for (int i = 0; i < 100; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ASSERT_EQ(stat(lock().c_str(), &status), 0);
    if (std::time(nullptr) - status.st_mtime < 500) break;
  }
  EXPECT_LT(std::time(nullptr) - status.st_mtime, 500);
  EXPECT_FALSE(held.stop.cancelled());
  EXPECT_FALSE(ErrorOf([&] { held.lock.ThrowIfLost(); }));
}

TEST_F(RunLockTest, AnOwnerNoticesThatItsLockWasTakenOver) {
  for (const bool deleted : {false, true}) {
    const TestLock held(state());
    const std::string foreign = ReadFile(lock());
    std::filesystem::remove(lock());
    if (!deleted) {
      auto json = nlohmann::json::parse(foreign);
      json["host"] = "box-b2";
      json["token"] = "another";
      WriteFile(lock(), json.dump());
    }
    const auto error = ErrorOf([&] { held.lock.ThrowIfLost(); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kLocked);
    EXPECT_THAT(error->what(), HasSubstr(deleted ? "deleted" : "box-b2"));
    for (int i = 0; i < 100 && !held.stop.cancelled(); ++i)
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    EXPECT_TRUE(held.stop.cancelled());
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
    EXPECT_FALSE(ErrorOf([&] { TestLock second(state()); }))
        << text.substr(0, 50);
    EXPECT_FALSE(std::filesystem::exists(lock()));
  }
}

TEST_F(RunLockTest, MessagesShowNoControlCharacters) {
  WriteFile(lock(), ChangedLock([](nlohmann::json& json) {
              json["host"] = "a\x1b[2J\nb";
              json["flock"] = false;
            }));
  const auto error = ErrorOf([&] { TestLock second(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(std::string(error->what()).find_first_of("\x1b\n"),
            std::string::npos);
}

TEST_F(RunLockTest, OnlyTheOwnLockIsRemoved) {
  {
    const TestLock held(state());
    WriteFile(lock(), "another run");
  }
  EXPECT_EQ(ReadFile(lock()), "another run");
}

TEST_F(RunLockTest, LinksAreNotFollowed) {
  std::filesystem::create_directories(state());
  const auto canary = folder_.path() / "canary";
  std::filesystem::create_symlink(canary, lock());
  const auto error = ErrorOf([&] { TestLock held(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_FALSE(std::filesystem::exists(canary));
}

TEST_F(RunLockTest, AFolderThatCannotBeMadeIsNamed) {
  WriteFile(folder_.path() / "stereo", "a file");
  const auto error = ErrorOf([&] { TestLock held(state()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr(state().string()));
}

// Takers that race for a stale lock: inside the lock each creates a file that
// must not be there yet.
class ManyTakersTest : public RunLockTest,
                       public testing::WithParamInterface<bool> {};

INSTANTIATE_TEST_SUITE_P(NearAndFar, ManyTakersTest, testing::Bool());

TEST_P(ManyTakersTest, OneIsInside) {
  const LockRules rules = GetParam() ? FastRules() : FarRules();
  const int kNumRounds = GetParam() ? 20 : 5;
  const pid_t owner = ForkOwner(state());
  ASSERT_GT(owner, 0);
  Kill(owner);
  const std::string stale = ReadFile(lock());
  const std::string inside = (folder_.path() / "inside").string();
  constexpr int kNumTakers = 8;
  for (int round = 0; round < kNumRounds; ++round) {
    WriteFile(lock(), stale);
    std::vector<pid_t> takers;
    for (int i = 0; i < kNumTakers; ++i) {
      const pid_t pid = fork();
      if (pid == 0) {
        int result = 1;
        try {
          const TestLock lock(state(), rules);
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
