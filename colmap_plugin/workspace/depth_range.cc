#include "colmap_plugin/workspace/depth_range.h"

#include "src/base/error.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr float kLowerFactor = 0.75f;
constexpr float kUpperFactor = 1.25f;
constexpr float kMinOverMax = 0.001f;  // in place of a lower end of zero

DepthRange Widened(DepthRange range) {
  if (range.min <= 0) range.min = kMinOverMax * range.max;
  if (range.min >= range.max)
    range = {kLowerFactor * range.max, kUpperFactor * range.max};
  return range;
}

// COLMAP's percentile: the float32 product, truncated. Reorders `depths`.
float DepthPercentile(float fraction, std::vector<float>* depths) {
  const size_t n = depths->size();
  const size_t rank =
      std::min(n - 1, static_cast<size_t>(static_cast<float>(n) * fraction));
  const auto it = depths->begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(depths->begin(), it, depths->end());
  return *it;
}

bool IsRange(const DepthRange& range) {
  return range.min > 0 && range.min < range.max && std::isfinite(range.max);
}

std::vector<std::optional<DepthRange>> AutomaticRanges(
    const Workspace& workspace) {
  std::vector<std::vector<float>> depths(workspace.num_images());
  for (const SparsePoint& point : workspace.model().points) {
    for (const int image : point.track) {
      if (!workspace.usable(image)) continue;
      const auto z = static_cast<float>(workspace.Depth(image, point.xyz));
      if (z > 0 && std::isfinite(z)) depths[image].push_back(z);
    }
  }
  std::vector<std::optional<DepthRange>> ranges(depths.size());
  for (size_t image = 0; image < depths.size(); ++image) {
    if (depths[image].empty()) continue;
    const DepthRange range =
        Widened({kLowerFactor * DepthPercentile(0.01f, &depths[image]),
                 kUpperFactor * DepthPercentile(0.99f, &depths[image])});
    if (IsRange(range)) ranges[image] = range;
  }
  return ranges;
}

}  // namespace

DepthRanges::DepthRanges(const Workspace& workspace,
                         double given_min,
                         double given_max)
    : workspace_(workspace), automatic_(AutomaticRanges(workspace)) {
  if (given_min < 0 || given_max < 0) return;
  given_ =
      Widened({static_cast<float>(given_min), static_cast<float>(given_max)});
  if (!(given_min <= given_max) || !IsRange(*given_)) {
    throw Error(ErrorCode::kUsage,
                fmt::format("--PatchMatchStereo.depth_min {} and "
                            "--PatchMatchStereo.depth_max {} "
                            "are no range; give 0 <= depth_min <= depth_max "
                            "with depth_max > 0, "
                            "or -1 for both",
                            given_min,
                            given_max));
  }
}

DepthRange DepthRanges::ForImage(int image) const {
  if (given_) {
    const DepthRange seen = automatic_[image].value_or(*given_);
    return {std::clamp(seen.min, given_->min / kSearchedBeyond, given_->min),
            std::clamp(seen.max, given_->max, kSearchedBeyond * given_->max)};
  }
  if (!automatic_[image]) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("image {} sees no sparse points, so its depth "
                            "range is unknown; set "
                            "both --PatchMatchStereo.depth_min and "
                            "--PatchMatchStereo.depth_max",
                            workspace_.ImageName(image)));
  }
  return *automatic_[image];
}

}  // namespace hpm
