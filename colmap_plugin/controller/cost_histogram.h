// How well the hypotheses of a map match, as counts of pixels by cost.
#pragma once

#include "src/core/limits.h"

#include <array>
#include <cstdint>
#include <optional>

#include <nlohmann/json.hpp>

namespace hpm {

constexpr int kNumCostBins = 20;  // of equal width, over [0, kMaxCost]

// Costs are those that the last pass accepted the hypotheses with: 1 - NCC over
// the views it trusted, and in geometric stages the geometric term, so that a
// few lie above kMaxCost; these are in the last bin. Median and fitted planes,
// which come after, are not matched again.
struct CostHistogram {
  std::array<uint64_t, kNumCostBins> bins = {};

  void Add(float cost) { ++bins[BinOf(cost)]; }
  CostHistogram& operator+=(const CostHistogram& other);
  uint64_t Count() const;
  // By linear interpolation inside a bin; 0 for no pixels.
  double Median() const;

 private:
  static int BinOf(float cost) {
    constexpr float kBinsPerCost = kNumCostBins / kMaxCost;
    if (!(cost < kMaxCost)) return kNumCostBins - 1;  // NaN, too
    return cost > 0 ? static_cast<int>(cost * kBinsPerCost) : 0;
  }
};

nlohmann::json ToJson(const CostHistogram& histogram);

// Nothing where it is no histogram: others may have written it.
std::optional<CostHistogram> CostHistogramFrom(const nlohmann::json& json);

}  // namespace hpm
