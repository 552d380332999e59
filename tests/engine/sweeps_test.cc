#include "src/engine/sweeps.h"

#include <ostream>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {

// For readable messages.
static void PrintTo(const Sweep& sweep, std::ostream* out) {
  *out << "kind " << static_cast<int>(sweep.kind) << ", colour " << sweep.color
       << ", iteration " << sweep.iteration;
}

namespace {

MATCHER_P3(Is, kind, color, iteration, "") {
  return arg.kind == kind && arg.color == color && arg.iteration == iteration;
}

constexpr SweepKind kUpdate = SweepKind::kUpdate;
constexpr SweepKind kFollow = SweepKind::kFollow;
constexpr SweepKind kMedian = SweepKind::kMedian;

TEST(Sweeps, AnIterationVisitsOneColourAfterTheOther) {
  const Pass pass = {PassKind::kBasic, StartFrom::kStored, 2, 0};
  EXPECT_THAT(SweepsOf(pass, 1),
              testing::ElementsAre(Is(kUpdate, 0, 0),
                                   Is(kUpdate, 1, 0),
                                   Is(kUpdate, 0, 1),
                                   Is(kUpdate, 1, 1),
                                   Is(kMedian, 0, 1),
                                   Is(kMedian, 1, 1)));
}

// A visit reads the other colour only, so what has been found comes on by those
// that follow.
TEST(Sweeps, OfHalfVisitsTheOtherColourFollowsAfterEachIteration) {
  Pass pass = {PassKind::kBasic, StartFrom::kStored, 2, 0, 0, false};
  pass.half_visits = true;
  EXPECT_THAT(SweepsOf(pass, 1),
              testing::ElementsAre(Is(kUpdate, 1, 0),
                                   Is(kFollow, 0, 0),
                                   Is(kUpdate, 1, 1),
                                   Is(kFollow, 0, 1)));
}

}  // namespace
}  // namespace hpm
