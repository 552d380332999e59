#include "src/core/prior_term.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

const PriorTerm kTerm = {0.5f, 0.18f, 0.1f, 0.0872665f};
const Vec3f kNormal = {0, 0, -1};

Vec3f TurnedBy(float angle) { return {std::sin(angle), 0, -std::cos(angle)}; }

// ACMP's posterior as a product of all its factors.
double Posterior(double cost, double dz, double angle) {
  return std::exp(-cost * cost / 0.18) *
         (0.5 + std::exp(-dz * dz / (2 * 0.01)) *
                    std::exp(-angle * angle / (2 * 0.0872665 * 0.0872665)));
}

TEST(PriorBonus, MinusTheSquaredCostIsTheLogarithmOfThePosterior) {
  for (const float cost : {0.0f, 0.1f, 0.7f}) {
    for (const float dz : {0.0f, 0.05f, -0.2f}) {
      for (const float angle : {0.0f, 0.05f, 0.2f}) {
        const float bonus =
            PriorBonus(kTerm, 3 + dz, TurnedBy(angle), 3, kNormal);
        EXPECT_NEAR((bonus - cost * cost) / kTerm.beta,
                    std::log(Posterior(cost, dz, angle)),
                    2e-4);
      }
    }
  }
}

TEST(PriorBonus, IsLargestOnThePrior) {
  const float best = PriorBonus(kTerm, 3, kNormal, 3, kNormal);
  EXPECT_GT(best, PriorBonus(kTerm, 3.02f, kNormal, 3, kNormal));
  EXPECT_GT(best, PriorBonus(kTerm, 2.98f, kNormal, 3, kNormal));
  EXPECT_GT(best, PriorBonus(kTerm, 3, TurnedBy(0.02f), 3, kNormal));
}

// The prior can make up for a limited difference in cost only.
TEST(PriorBonus, ChangesTheProbabilityByAFactorOfThreeAtMost) {
  const float on = PriorBonus(kTerm, 3, kNormal, 3, kNormal);
  const float off = PriorBonus(kTerm, 30, TurnedBy(1.5f), 3, kNormal);
  EXPECT_NEAR(on - off, kTerm.beta * std::log(3.0f), 1e-6);
}

TEST(AngleBetween, SurvivesDotProductsBeyondOne) {
  const Vec3f longer = {0, 0, -1.0000002f};
  EXPECT_EQ(AngleBetween(longer, longer), 0);
  EXPECT_FALSE(std::isnan(AngleBetween(longer, -longer)));
  EXPECT_NEAR(AngleBetween(kNormal, TurnedBy(0.3f)), 0.3f, 1e-5);
}

}  // namespace
}  // namespace hpm
