#include "colmap_plugin/controller/cost_histogram.h"

#include <cstddef>
#include <numeric>

namespace hpm {

CostHistogram& CostHistogram::operator+=(const CostHistogram& other) {
  for (size_t i = 0; i < bins.size(); ++i) bins[i] += other.bins[i];
  return *this;
}

uint64_t CostHistogram::Count() const {
  return std::accumulate(bins.begin(), bins.end(), uint64_t{0});
}

double CostHistogram::Median() const {
  constexpr double kBinWidth = static_cast<double>(kMaxCost) / kNumCostBins;
  double left = static_cast<double>(Count()) / 2;
  for (size_t i = 0; i < bins.size(); ++i) {
    const auto here = static_cast<double>(bins[i]);
    if (here > 0 && left <= here)
      return kBinWidth * (static_cast<double>(i) + left / here);
    left -= here;
  }
  return 0;
}

nlohmann::json ToJson(const CostHistogram& histogram) { return histogram.bins; }

std::optional<CostHistogram> CostHistogramFrom(const nlohmann::json& json) {
  // An image has fewer pixels; sums of many images cannot overflow then.
  constexpr uint64_t kMaxPixels = uint64_t{1} << 40;
  CostHistogram histogram;
  if (!json.is_array() || json.size() != histogram.bins.size())
    return std::nullopt;
  for (size_t i = 0; i < histogram.bins.size(); ++i) {
    if (!json[i].is_number_unsigned()) return std::nullopt;
    histogram.bins[i] = json[i].get<uint64_t>();
    if (histogram.bins[i] > kMaxPixels) return std::nullopt;
  }
  return histogram;
}

}  // namespace hpm
