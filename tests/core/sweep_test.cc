#include "src/core/sweep.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

// A picture of one pixel that so many iterations visit.
bool IsPassedOver(SweepKind kind, int iteration, const uint8_t* visits) {
  PixelState state = {};
  state.width = state.height = 1;
  state.visits = visits;
  Sweep sweep = {};
  sweep.kind = kind;
  sweep.iteration = iteration;
  return PassesOver(sweep, state, 0, 0);
}

TEST(PassesOver, IterationsBeyondThoseThatVisitThePixel) {
  const uint8_t none = 0, two = 2;
  EXPECT_TRUE(IsPassedOver(SweepKind::kUpdate, 0, &none));
  EXPECT_FALSE(IsPassedOver(SweepKind::kUpdate, 1, &two));
  EXPECT_TRUE(IsPassedOver(SweepKind::kUpdate, 2, &two));
}

// There may be more iterations than a byte can count.
TEST(PassesOver, NoIterationWhereAllVisit) {
  EXPECT_FALSE(IsPassedOver(SweepKind::kUpdate, 300, &kAllVisits));
  EXPECT_FALSE(IsPassedOver(SweepKind::kUpdate, 300, nullptr));
}

// A start gives every pixel a cost, whoever is visited afterwards.
TEST(PassesOver, NoStart) {
  const uint8_t none = 0;
  EXPECT_FALSE(IsPassedOver(SweepKind::kInitialize, 0, &none));
}

}  // namespace
}  // namespace hpm
