#include "src/gpu/band_planner.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr SweepKind kKind = SweepKind::kUpdate;

TEST(BandPlannerTest, BeginsSmallAndInWholeTiles) {
  const BandPlanner planner(0.03);
  EXPECT_EQ(planner.NextRows(kKind, 2130, 8), 64);
  EXPECT_EQ(planner.NextRows(kKind, 2130, 24), 48);
  EXPECT_EQ(planner.NextRows(kKind, 5, 8), 5);
}

TEST(BandPlannerTest, AimsAtTheTargetAfterReports) {
  BandPlanner planner(0.03);
  planner.Report(kKind, 64, 0.015);
  EXPECT_EQ(planner.NextRows(kKind, 10000, 8), 128);
  planner.Report(kKind, 128, 0.3);
  EXPECT_EQ(planner.NextRows(kKind, 10000, 8), 8);
}

TEST(BandPlannerTest, GrowsByAtMostFourAndNeverStops) {
  BandPlanner planner(0.03);
  planner.Report(kKind, 64, 0);
  EXPECT_EQ(planner.NextRows(kKind, 1 << 30, 8), 256);
  planner.Report(kKind, 256, 1e-9);
  EXPECT_EQ(planner.NextRows(kKind, 1 << 30, 8), 1024);
  planner.Report(kKind, 8, 1e9);
  EXPECT_EQ(planner.NextRows(kKind, 10000, 8), 8);
}

// A launch costs no more than the card has shown, even at a quarter of its
// speed.
TEST(BandPlannerTest, NoLaunchOfASteadyCardExceedsTheTarget) {
  for (const double rows_per_second : {1e2, 3e3, 1e5, 1e7}) {
    BandPlanner planner(0.03);
    int row = 0;
    double longest = 0;
    while (row < 100000) {
      const int rows = planner.NextRows(kKind, 100000 - row, 8);
      const double seconds = rows / rows_per_second;
      if (row > 0) longest = std::max(longest, seconds);
      planner.Report(kKind, rows, seconds);
      row += rows;
    }
    EXPECT_LE(longest, std::max(0.031, 8 / rows_per_second));
  }
}

TEST(BandPlannerTest, KindsAreApart) {
  for (int reported = 0; reported < kNumSweepKinds; ++reported) {
    BandPlanner planner(0.03);
    planner.Report(static_cast<SweepKind>(reported), 64, 1e-6);
    for (int kind = 0; kind < kNumSweepKinds; ++kind) {
      EXPECT_EQ(planner.NextRows(static_cast<SweepKind>(kind), 10000, 8),
                kind == reported ? 256 : 64);
    }
  }
}

}  // namespace
}  // namespace hpm
