#include "src/engine/memory_plan.h"

#include "src/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr uint64_t kMegabyte = 1 << 20;
constexpr uint64_t kGigabyte = 1 << 30;

TEST(PlanCacheBytes, GivesWhatIsAskedWhereItFits) {
  EXPECT_EQ(PlanCacheBytes(
                300 * kMegabyte, kGigabyte, 100 * kMegabyte, 16 * kGigabyte),
            300 * kMegabyte);
}

// So that memory does not grow with the number of images.
TEST(PlanCacheBytes, GivesNoMoreThanPays) {
  EXPECT_EQ(PlanCacheBytes(
                32 * kGigabyte, kGigabyte, 100 * kMegabyte, 64 * kGigabyte),
            512 * kMegabyte);
  EXPECT_EQ(
      PlanCacheBytes(32 * kGigabyte, kGigabyte, 3 * kGigabyte, 64 * kGigabyte),
      3 * kGigabyte);
}

TEST(PlanCacheBytes, GivesNoMoreThanTheLimitLeaves) {
  const uint64_t cache = PlanCacheBytes(
      32 * kGigabyte, 3500 * kMegabyte, 100 * kMegabyte, 4 * kGigabyte);
  EXPECT_LT(cache, 500 * kMegabyte);
  EXPECT_GT(cache, 300 * kMegabyte);
}

TEST(PlanCacheBytes, GivesNoLessThanOneProblemNeeds) {
  EXPECT_EQ(PlanCacheBytes(0, kGigabyte, 100 * kMegabyte, 16 * kGigabyte),
            100 * kMegabyte);
}

TEST(PlanCacheBytes, RefusesWhatCannotFitAndSaysWhatToDo) {
  for (const auto& [working, min_cache] :
       {std::pair{5 * kGigabyte, kMegabyte}, {kMegabyte, 5 * kGigabyte}}) {
    try {
      PlanCacheBytes(kGigabyte, working, min_cache, 4 * kGigabyte);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfResources);
      EXPECT_THAT(error.what(), testing::HasSubstr("smaller images"));
      EXPECT_THAT(error.what(), testing::HasSubstr("4096 MB"));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }
}

TEST(MemoryLimit, IsOfThisMachinesOrder) {
  EXPECT_GT(MemoryLimit(), 64 * kMegabyte);
  EXPECT_LT(MemoryLimit(), uint64_t{1} << 50);
}

}  // namespace
}  // namespace hpm
