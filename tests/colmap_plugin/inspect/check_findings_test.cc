#include "colmap_plugin/inspect/check_findings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

MapCheck CheckWith(const std::vector<FindingKind>& kinds) {
  MapCheck check;
  for (const FindingKind kind : kinds)
    check.findings.push_back({kind, "a.jpg", "reason"});
  return check;
}

TEST(CheckFindings, TheWorstOneIsTheExitCode) {
  using Kind = FindingKind;
  EXPECT_EQ(CheckWith({}).ExitCode(), 0);
  EXPECT_EQ(CheckWith({Kind::kForeign}).ExitCode(), 0);
  for (const Kind kind : {Kind::kStale, Kind::kUnstamped, Kind::kMissing})
    EXPECT_EQ(CheckWith({Kind::kForeign, kind}).ExitCode(), 4);
  for (const Kind kind : {Kind::kDamaged, Kind::kUnreadable})
    EXPECT_EQ(CheckWith({Kind::kMissing, kind}).ExitCode(), 3);
  MapCheck mended = CheckWith({Kind::kDamaged});
  mended.findings[0].removed = true;
  EXPECT_EQ(mended.ExitCode(), 4);
}

TEST(CheckFindings, AreALineEachAndCounted) {
  MapCheck check = CheckWith({FindingKind::kDamaged, FindingKind::kUnreadable});
  check.num_files = 7;
  check.findings[0].removed = true;
  EXPECT_EQ(CheckText(check),
            "damaged a.jpg (removed): reason\n"
            "unreadable a.jpg: reason\n"
            "7 files read: 1 damaged, 1 unreadable, 0 stale, 0 unstamped, 0 "
            "foreign, 0 missing\n");
  EXPECT_THAT(CheckText(CheckWith({FindingKind::kStale})),
              testing::HasSubstr("give check the options of the run"));
}

}  // namespace
}  // namespace hpm
