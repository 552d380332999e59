#include "colmap_plugin/controller/run_share.h"

#include "src/base/error.h"

#include <algorithm>
#include <string>

#include <gtest/gtest.h>

namespace hpm {
namespace {

RunShare Share(const std::string& shard, const std::string& stage = "all") {
  HpmOptions options;
  options.shard = shard;
  options.stage = stage;
  return RunShare(options);
}

std::vector<StereoProblem> Problems(int num_references, int num_sources) {
  std::vector<StereoProblem> problems(num_references + num_sources);
  for (size_t p = 0; p < problems.size(); ++p) {
    problems[p].ref_image = static_cast<int>(p);
    problems[p].is_reference = static_cast<int>(p) < num_references;
  }
  return problems;
}

TEST(RunShare, EachProblemIsInOneShardAndShardsAreContiguousAndEven) {
  for (const int num_references : {1, 2, 7, 100}) {
    const auto problems = Problems(num_references, 5);
    const int num_images = num_references + 5;
    for (const int count : {1, 2, 3, 7, 150}) {
      std::vector<int> shard_of(problems.size(), -1);
      std::vector<int> sizes;
      for (int i = 0; i < count; ++i) {
        const std::vector<bool> mine =
            Share(std::to_string(i) + "/" + std::to_string(count))
                .Problems(problems, num_images);
        ASSERT_EQ(mine.size(), problems.size());
        sizes.push_back(static_cast<int>(
            std::count(mine.begin(), mine.begin() + num_references, true)));
        for (size_t p = 0; p < mine.size(); ++p) {
          if (!mine[p]) continue;
          EXPECT_EQ(shard_of[p], -1);
          shard_of[p] = i;
        }
      }
      EXPECT_EQ(std::count(shard_of.begin(), shard_of.end(), -1), 0);
      EXPECT_TRUE(
          std::is_sorted(shard_of.begin(), shard_of.begin() + num_references));
      const auto [least, most] =
          std::minmax_element(sizes.begin(), sizes.end());
      EXPECT_LE(*most - *least, 1);
    }
  }
}

// A source that another process does not know of moves no other one.
TEST(RunShare, SourcesAreDividedByTheirPlaceInTheModel) {
  auto problems = Problems(3, 6);
  const std::vector<bool> all = Share("1/3").Problems(problems, 9);
  problems.erase(problems.begin() + 4);
  std::vector<bool> expected = all;
  expected.erase(expected.begin() + 4);
  EXPECT_EQ(Share("1/3").Problems(problems, 9), expected);
}

TEST(RunShare, KnowsItsStage) {
  EXPECT_TRUE(Share("0/1").IsWhole());
  EXPECT_FALSE(Share("0/2").IsWhole());
  EXPECT_FALSE(Share("0/1", "photometric").IsWhole());
  EXPECT_TRUE(Share("0/1").HasStage("geometric"));
  EXPECT_FALSE(Share("0/1", "photometric").HasStage("geometric"));
  EXPECT_FALSE(Share("0/1", "finish").HasStage("geometric"));
  EXPECT_TRUE(Share("0/1", "finish").Finishes());
  EXPECT_NO_THROW(Share("0/1", "b").CheckStage({"a", "b"}));
  EXPECT_NO_THROW(Share("0/1", "finish").CheckStage({"a", "b"}));
  EXPECT_THROW(Share("0/1", "c").CheckStage({"a", "b"}), Error);
  EXPECT_THROW(Share("1/1"), Error);
}

}  // namespace
}  // namespace hpm
