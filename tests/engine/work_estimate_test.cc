#include "src/engine/work_estimate.h"

#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

// Of the whole run, in percent, the filter with the last stage.
std::vector<double> Shares(const ScheduleOptions& options) {
  std::vector<double> work;
  for (const StageSpec& stage : MakeSchedule(options).stages)
    work.push_back(StageWork(stage) / (1 << (2 * stage.level)));
  work.back() += kFilterWork;
  const double sum = std::accumulate(work.begin(), work.end(), 0.0);
  for (double& share : work) share *= 100 / sum;
  return work;
}

// Of the CPU's time, measured on three scenes at 320 pixels, two levels: from
// the smallest share to the largest, with a point more on either side.
TEST(WorkEstimate, StagesTakeWhatWasMeasured) {
  const std::vector<double> shares = Shares({"hpm_plus", -1, -1, -1, 2});
  const double measured[][2] = {
      {12.9, 15.6}, {3.7, 6.4}, {5.4, 8.2}, {39.3, 52.2}, {23.2, 32.6}};
  ASSERT_EQ(shares.size(), std::size(measured));
  for (size_t i = 0; i < shares.size(); ++i) {
    EXPECT_GT(shares[i], measured[i][0] - 1) << i;
    EXPECT_LT(shares[i], measured[i][1] + 1) << i;
  }
}

TEST(WorkEstimate, StagesOfThePaperTakeWhatWasMeasured) {
  const std::vector<double> shares = Shares({"hpm", -1, -1, -1, 1});
  const double measured[] = {48.3, 26.2, 25.4};
  ASSERT_EQ(shares.size(), std::size(measured));
  for (size_t i = 0; i < shares.size(); ++i)
    EXPECT_NEAR(shares[i], measured[i], 2) << i;
}

TEST(WorkEstimate, AStartIsCheapAndTheStepsAddUp) {
  const Pass pass = {PassKind::kBasic, StartFrom::kRandom, 2, 0};
  ASSERT_EQ(pass.NumSteps(), 6);
  EXPECT_EQ(StepsWork(pass, 0), 0);
  EXPECT_LT(StepsWork(pass, 2), 0.1 * PassWork(pass));
  for (int step = 1; step <= 6; ++step)
    EXPECT_GT(StepsWork(pass, step), StepsWork(pass, step - 1));
  EXPECT_EQ(StepsWork(pass, 6), PassWork(pass));
}

TEST(WorkEstimate, AStageWithoutPassesTakesNothing) {
  StageSpec stage;
  stage.from_coarser = true;
  EXPECT_EQ(StageWork(stage), 0);
}

}  // namespace
}  // namespace hpm
