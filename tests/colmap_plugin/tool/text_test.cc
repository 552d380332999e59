#include "colmap_plugin/tool/text.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(TextTest, OneLineKeepsUtf8AndReplacesControlCharacters) {
  EXPECT_EQ(OneLine("a\nb\tc\x7f\x1b[m \n"), "a b c  [m");
  EXPECT_EQ(OneLine("\xc3\xa4"), "\xc3\xa4");
}

TEST(TextTest, DurationsHaveTwoUnitsAtMost) {
  EXPECT_EQ(FormatDuration(0), "0 s");
  EXPECT_EQ(FormatDuration(59.4), "59 s");
  EXPECT_EQ(FormatDuration(59.6), "1 min 00 s");
  EXPECT_EQ(FormatDuration(200), "3 min 20 s");
  EXPECT_EQ(FormatDuration(3720), "1 h 02 min");
  EXPECT_EQ(FormatDuration(-5), "0 s");
  EXPECT_EQ(FormatDuration(INFINITY), "744 h 00 min");
}

TEST(TextTest, LikelyNamesAreThoseOfASlipOfTheHand) {
  const std::vector<std::string> names = {"check", "plan", "Hpm.quality"};
  EXPECT_EQ(LikelyName("chek", names), "check");
  EXPECT_EQ(LikelyName("Hpm.qualty", names), "Hpm.quality");
  EXPECT_EQ(LikelyName("Hpm-quality", names), "Hpm.quality");
  EXPECT_EQ(LikelyName("plna", names), "");  // two of four letters
  EXPECT_EQ(LikelyName("fuse", names), "");
  EXPECT_EQ(LikelyName("", names), "");
  EXPECT_EQ(LikelyName("workspace-path", {"workspace_path"}), "workspace_path");
}

TEST(TextTest, ShellWordQuotesOnlyWhatNeedsIt) {
  EXPECT_EQ(ShellWord("/a/b-1.ply"), "/a/b-1.ply");
  EXPECT_EQ(ShellWord("a b"), "'a b'");
  EXPECT_EQ(ShellWord("it's; rm"), "'it'\\''s; rm'");
  EXPECT_EQ(ShellWord(""), "''");
}

TEST(TextTest, WrapBreaksAtBlanksOnly) {
  EXPECT_EQ(Wrap("aa bb cc", 7, 2), "  aa bb\n  cc\n");
  EXPECT_EQ(Wrap("aaaaaaaaaaaa b", 7, 2), "  aaaaaaaaaaaa\n  b\n");
  EXPECT_EQ(Wrap("", 7, 2), "  \n");
}

}  // namespace
}  // namespace hpm
