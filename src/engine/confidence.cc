#include "src/engine/confidence.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// More agreeing views than that tell no more.
constexpr int kEnoughAgreeing = 8;
// What COLMAP's filter asks for.
constexpr int kFewAgreeing = 2;

// Logistic regression on the pixels of five scenes, each of the same weight.
double LogOdds(int num_agreeing, int num_seeing, float cost, bool unexplained) {
  const double share =
      static_cast<double>(num_agreeing) / std::max(num_seeing, 1);
  return -0.457 +
         0.946 * std::min(num_agreeing, kEnoughAgreeing) / kEnoughAgreeing +
         0.853 * std::min(num_agreeing, kFewAgreeing) / kFewAgreeing +
         share * (0.283 + 1.697 * share) -
         0.659 * std::clamp(cost, 0.0f, 1.0f) +
         (unexplained ? -1.625 - 0.123 * share : 0);
}

}  // namespace

std::vector<float> Confidence(const NeededViews& views,
                              const HypothesisMap& map,
                              const std::vector<uint32_t>& consistent) {
  // Finer steps than any use of it needs, so that no library's exp() shows.
  constexpr double kSteps = 1000;
  std::vector<float> confidence(consistent.size());
  tbb::parallel_for(0, map.height, [&](int row) {
    const size_t begin = static_cast<size_t>(row) * map.width;
    for (size_t i = begin; i < begin + map.width; ++i) {
      const int num_agreeing = __builtin_popcount(consistent[i]);
      // All that agree see it, even where something hides it from some.
      const int num_seeing = std::max(num_agreeing, views.CountSeeing(i));
      const bool unexplained = !map.unexplained.empty() && map.unexplained[i];
      const double odds =
          LogOdds(num_agreeing, num_seeing, map.costs[i], unexplained);
      confidence[i] = static_cast<float>(
          std::round(kSteps / (1 + std::exp(-odds))) / kSteps);
    }
  });
  return confidence;
}

}  // namespace hpm
