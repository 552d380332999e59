#include "colmap_plugin/workspace/planning_progress.h"

#include "src/base/error.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(PlanningProgress, TellsHowFarItIsNotTooOften) {
  std::vector<std::string> lines;
  const LogSink log = [&](LogLevel, const std::string& line) {
    lines.push_back(line);
  };
  const CancelToken cancel;
  PlanningProgress eager(
      "Choosing", 3, log, cancel, std::chrono::milliseconds(0));
  eager.Count();
  eager.Count();
  EXPECT_THAT(lines,
              testing::ElementsAre("Choosing: 1 of 3 images",
                                   "Choosing: 2 of 3 images"));
  PlanningProgress calm("Choosing", 3, log, cancel);
  calm.Count();
  EXPECT_EQ(lines.size(), 2u);
}

TEST(PlanningProgress, HearsCancelWithAndWithoutALog) {
  const LogSink none;
  CancelToken cancel;
  PlanningProgress progress("Choosing", 3, none, cancel);
  EXPECT_NO_THROW(progress.Count());
  cancel.Cancel();
  EXPECT_THROW(progress.Count(), Error);
}

}  // namespace
}  // namespace hpm
