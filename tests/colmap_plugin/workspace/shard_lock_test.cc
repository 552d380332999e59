// Runs on the shards of a workspace beside each other and beside one on all of
// it.
#include "colmap_plugin/workspace/run_lock.h"
#include "tests/colmap_plugin/workspace/test_lock.h"

#include <cstdlib>

namespace hpm {
namespace {

class ShardLockTest : public testing::Test {
 protected:
  std::filesystem::path state() const { return folder_.path() / "state"; }

  ScratchFolder folder_;
};

TEST_F(ShardLockTest, ShardsOfOneDivisionGoTogetherAndNothingElseDoes) {
  const auto error_of = [&](int index, int count) {
    const auto error = ErrorOf([&] {
      TestLock(state(), FastRules(), {index, count});
    });
    if (error) {
      EXPECT_EQ(error->code(), ErrorCode::kLocked);
    }
    return error.has_value();
  };
  {
    const TestLock held(state(), FastRules(), {0, 3});
    const TestLock beside(state(), FastRules(), {2, 3});
    EXPECT_FALSE(error_of(1, 3));
    EXPECT_TRUE(error_of(0, 3));
    EXPECT_TRUE(error_of(1, 4));
    EXPECT_TRUE(error_of(1, 13));
    EXPECT_TRUE(error_of(0, 1));
    // The refused have left nothing that would refuse others.
    EXPECT_FALSE(error_of(1, 3));
  }
  const TestLock whole(state());
  EXPECT_TRUE(error_of(0, 3));
}

TEST_F(ShardLockTest, LocksOfDeadShardsRefuseNobody) {
  const pid_t owner = ForkOwner(state(), FastRules(), {1, 3});
  ASSERT_GT(owner, 0);
  EXPECT_TRUE(ErrorOf([&] { TestLock whole(state()); }));
  Kill(owner);
  const std::filesystem::path left = state() / "lock.1-of-3";
  EXPECT_TRUE(std::filesystem::exists(left));
  EXPECT_FALSE(ErrorOf([&] { TestLock whole(state()); }));
  EXPECT_FALSE(std::filesystem::exists(left));
}

TEST_F(ShardLockTest, TheJobOfABatchSystemIsNamed) {
  setenv("SLURM_JOB_ID", "4711", 1);
  setenv("SLURM_ARRAY_TASK_ID", "3", 1);
  const pid_t owner = ForkOwner(state());
  unsetenv("SLURM_JOB_ID");
  unsetenv("SLURM_ARRAY_TASK_ID");
  ASSERT_GT(owner, 0);
  const auto error = ErrorOf([&] { TestLock second(state()); });
  Kill(owner);
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), testing::HasSubstr("4711_3"));
}

}  // namespace
}  // namespace hpm
