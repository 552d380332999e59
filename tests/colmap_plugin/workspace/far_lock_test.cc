// Locks of other machines, and on file systems whose flock is not trusted.
#include "tests/colmap_plugin/workspace/run_lock_fixture.h"

#include <atomic>
#include <thread>

#include <nlohmann/json.hpp>
#include <unistd.h>

namespace hpm {
namespace {

using testing::HasSubstr;

class FarLockTest : public RunLockTest {
 protected:
  // The lock of another machine, last touched so many seconds ago.
  std::string WriteForeignLock(int age) {
    const std::string foreign = ChangedLock([](nlohmann::json& json) {
      json["host"] = "far-away";
      json["boot_id"] = "elsewhere";
      json["flock"] = false;
    });
    WriteFile(lock(), foreign);
    SetAge(lock(), age);
    return foreign;
  }
};

TEST_F(FarLockTest, AnotherMachinesFreshLockIsRespected) {
  for (const LockRules& rules : {FastRules(), FarRules()}) {
    const std::string foreign = WriteForeignLock(200);
    const auto error = ErrorOf([&] { TestLock second(state(), rules); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kLocked);
    EXPECT_THAT(error->what(), HasSubstr("far-away"));
    EXPECT_THAT(error->what(), HasSubstr("300 seconds"));
    EXPECT_EQ(ReadFile(lock()), foreign);
    std::filesystem::remove(lock());
  }
}

TEST_F(FarLockTest, AnotherMachinesSilentLockIsTakenOverWithAWarning) {
  for (const int age : {400, -400}) {
    WriteForeignLock(age);
    const TestLock second(state(), FarRules());
    ASSERT_EQ(second.warnings.size(), 1u);
    EXPECT_THAT(second.warnings[0], HasSubstr("far-away"));
    EXPECT_THAT(ReadFile(lock()), HasSubstr(std::to_string(getpid())));
  }
  EXPECT_EQ(folder_.CountFiles(), 0u);
}

// Its clock goes wrong, or the server's.
TEST_F(FarLockTest, AnOldLockThatIsTouchedMeanwhileIsRespected) {
  WriteForeignLock(4000);
  std::atomic<bool> ending{false};
  std::thread owner([&] {
    for (int age = 3999; !ending; --age) {
      SetAge(lock(), age);
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  });
  const auto error = ErrorOf([&] { TestLock second(state(), FarRules()); });
  ending = true;
  owner.join();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kLocked);
}

TEST_F(FarLockTest, AProcessOfThisMachineIsAskedForAlsoThere) {
  const pid_t owner = ForkOwner(state(), FarRules());
  ASSERT_GT(owner, 0);
  EXPECT_TRUE(ErrorOf([&] { TestLock second(state(), FarRules()); }));
  Kill(owner);
  EXPECT_FALSE(ErrorOf([&] { TestLock second(state(), FarRules()); }));
}

TEST_F(FarLockTest, ATakerWhoseLockIsRemovedByAnotherGivesUp) {
  LockRules rules = FarRules();
  rules.settle = std::chrono::milliseconds(600);
  const std::string stale = WriteForeignLock(4000);
  std::thread other([&] {
    const auto is_taken = [&] {
      const std::string now = ReadFile(lock());
      return !now.empty() && now.back() == '}' && now != stale;
    };
    while (!is_taken())
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(rules.settle / 4);  // it waits by now
    WriteFile(lock(), "of another taker, who came later");
  });
  const auto error = ErrorOf([&] { TestLock second(state(), rules); });
  other.join();
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kLocked);
  EXPECT_EQ(ReadFile(lock()), "of another taker, who came later");
}

TEST_F(FarLockTest, WaitingCanBeInterrupted) {
  WriteForeignLock(4000);
  LockRules rules = FarRules();
  rules.watch = std::chrono::hours(1);
  CancelToken stop;
  stop.Cancel();
  const auto error = ErrorOf([&] {
    RunLock second(
        state(), [](LogLevel, const std::string&) {}, &stop, {}, rules);
  });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kInterrupted);
}

TEST_F(FarLockTest, LookingTakesALongSilenceForTheEnd) {
  WriteForeignLock(10);
  EXPECT_TRUE(ErrorOf([&] { ThrowIfLocked(state(), {}, FarRules()); }));
  SetAge(lock(), 4000);
  EXPECT_FALSE(ErrorOf([&] { ThrowIfLocked(state(), {}, FarRules()); }));
}

}  // namespace
}  // namespace hpm
