#include "colmap_plugin/controller/run_statistics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

class RunStatisticsTest : public testing::Test {
 protected:
  void AddFinal(const std::string& image, double valid, double range_loss) {
    Stage stage;
    stage.is_final = true;
    StageResult result;
    result.valid_pixel_share = valid;
    result.losses[FilterCriterion::kRange] = range_loss;
    result.costs.emplace().bins[1] = static_cast<uint64_t>(100 * valid);
    Camera camera = {};
    camera.width = camera.height = 10;
    statistics_.Add(image, true, stage, "geometric", camera, result);
  }

  RunStatistics statistics_;
};

// As after the run was planned anew.
TEST_F(RunStatisticsTest, AMapThatIsMadeAgainCountsOnce) {
  AddFinal("a", 0.2, 0.8);
  AddFinal("a", 0.6, 0.4);
  AddFinal("b", 1.0, 0.0);
  const RunSummary summary = statistics_.Summarize({"a", "b"}, "cpu", 1);
  EXPECT_EQ(summary.num_computed, 2);
  EXPECT_DOUBLE_EQ(summary.valid_pixel_share.value(), 0.8);
  EXPECT_DOUBLE_EQ(summary.filter_losses.at(FilterCriterion::kRange), 0.2);
  const nlohmann::json record = statistics_.Record({}, summary);
  EXPECT_EQ(record["cost_histogram"][1], 160);
  EXPECT_EQ(record["images"]["b"]["geometric"]["cost_histogram"][1], 100);
}

TEST_F(RunStatisticsTest, ASourceThatFailedIsKnownButNoFailedImage) {
  statistics_.AddFailure("reference", true);
  statistics_.AddFailure("source", false);
  EXPECT_TRUE(statistics_.HasFailed("reference"));
  EXPECT_TRUE(statistics_.HasFailed("source"));
  EXPECT_FALSE(statistics_.HasFailed("other"));
  EXPECT_THAT(statistics_.Summarize({"reference"}, "cpu", 1).failed,
              testing::ElementsAre("reference"));
}

}  // namespace
}  // namespace hpm
