#include "src/engine/confidence.h"

#include "src/engine/visit_params.h"

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

// By how many pixels of the median view 1 % of the depth moves a point: fewer
// or more than these tell no more.
constexpr float kRightWithin = 0.01f;
constexpr float kFewestPixels = 0.25f, kMostPixels = 16;

// Logistic regression on the pixels of five scenes, each of the same weight.
// moved: see kFewestPixels.
double LogOdds(int num_agreeing,
               int num_seeing,
               float cost,
               bool unexplained,
               float moved) {
  const double share =
      static_cast<double>(num_agreeing) / std::max(num_seeing, 1);
  const double octaves =
      std::log2(std::clamp(moved, kFewestPixels, kMostPixels));
  return -0.774 +
         1.038 * std::min(num_agreeing, kEnoughAgreeing) / kEnoughAgreeing +
         0.667 * std::min(num_agreeing, kFewAgreeing) / kFewAgreeing +
         share * (0.962 + 0.944 * share) -
         0.611 * std::clamp(cost, 0.0f, 1.0f) + 0.276 * octaves +
         (unexplained ? -1.916 + 0.271 * share : 0);
}

}  // namespace

std::vector<float> Confidence(const ViewSet& views,
                              const NeededViews& needed,
                              const HypothesisMap& map,
                              const std::vector<uint32_t>& consistent) {
  // Finer steps than any use of it needs, so that no library's exp() shows.
  constexpr double kSteps = 1000;
  const float parallax = MedianParallax(views);
  std::vector<float> confidence(consistent.size());
  tbb::parallel_for(0, map.height, [&](int row) {
    const size_t begin = static_cast<size_t>(row) * map.width;
    for (size_t i = begin; i < begin + map.width; ++i) {
      const int num_agreeing = __builtin_popcount(consistent[i]);
      // All that agree see it, even where something hides it from some.
      const int num_seeing = std::max(num_agreeing, needed.CountSeeing(i));
      const bool unexplained = !map.unexplained.empty() && map.unexplained[i];
      const float depth = DepthAt(views.ref.camera,
                                  map.planes[i],
                                  static_cast<float>(i - begin),
                                  static_cast<float>(row));
      const double odds = LogOdds(num_agreeing,
                                  num_seeing,
                                  map.costs[i],
                                  unexplained,
                                  kRightWithin * parallax / depth);
      confidence[i] = static_cast<float>(
          std::round(kSteps / (1 + std::exp(-odds))) / kSteps);
    }
  });
  return confidence;
}

}  // namespace hpm
