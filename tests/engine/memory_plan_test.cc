#include "src/engine/memory_plan.h"

#include "src/base/error.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr uint64_t kMegabyte = 1 << 20;
constexpr uint64_t kGigabyte = 1 << 30;

TEST(PlanCacheBytes, GivesWhatIsAskedWhereItFits) {
  EXPECT_EQ(
      PlanCacheBytes(2 * kGigabyte, kGigabyte, 100 * kMegabyte, 16 * kGigabyte),
      2 * kGigabyte);
}

TEST(PlanCacheBytes, GivesNoMoreThanTheLimitLeaves) {
  const uint64_t cache =
      PlanCacheBytes(32 * kGigabyte, kGigabyte, 100 * kMegabyte, 4 * kGigabyte);
  EXPECT_LT(cache, 3 * kGigabyte);
  EXPECT_GT(cache, 2 * kGigabyte);
}

TEST(PlanCacheBytes, GivesNoLessThanOneProblemNeeds) {
  EXPECT_EQ(PlanCacheBytes(0, kGigabyte, 100 * kMegabyte, 16 * kGigabyte),
            100 * kMegabyte);
}

TEST(PlanCacheBytes, RefusesWhatCannotFitAndNamesTheOption) {
  for (const auto& [working, min_cache] :
       {std::pair{5 * kGigabyte, kMegabyte}, {kMegabyte, 5 * kGigabyte}}) {
    try {
      PlanCacheBytes(kGigabyte, working, min_cache, 4 * kGigabyte);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kOutOfResources);
      EXPECT_THAT(error.what(), testing::HasSubstr("max_image_size"));
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
