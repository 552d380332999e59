#include "colmap_plugin/inspect/run_status.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace hpm {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

RunStatus StatusWith(int num_needed, const std::vector<std::string>& failing) {
  RunStatus status;
  status.stages = {{"photometric", 4, 0, 0, 0, 0},
                   {"geometric", 4 - num_needed, num_needed, 0, 0, 0}};
  status.failing = failing;
  return status;
}

bool IsCompleteInJson(const RunStatus& status) {
  return nlohmann::json::parse(StatusJson(status))["complete"];
}

TEST(RunStatus, IsCompleteInBothFormsOrInNeither) {
  const RunStatus complete = StatusWith(0, {});
  EXPECT_TRUE(IsCompleteInJson(complete));
  EXPECT_THAT(StatusText(complete), EndsWith("\ncomplete\n"));

  const RunStatus needs_run = StatusWith(2, {});
  EXPECT_FALSE(IsCompleteInJson(needs_run));
  EXPECT_THAT(StatusText(needs_run), HasSubstr("\nnot complete: run"));

  const RunStatus needs_picture = StatusWith(0, {"a.jpg"});
  EXPECT_FALSE(IsCompleteInJson(needs_picture));
  EXPECT_THAT(StatusText(needs_picture), HasSubstr("\nnot complete, and"));
  EXPECT_THAT(StatusText(needs_picture), HasSubstr("a.jpg"));
}

}  // namespace
}  // namespace hpm
