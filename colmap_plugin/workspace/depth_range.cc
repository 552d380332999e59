#include "colmap_plugin/workspace/depth_range.h"

#include "colmap_plugin/workspace/range_estimate.h"
#include "src/base/error.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include <fmt/format.h>
#include <tbb/enumerable_thread_specific.h>
#include <tbb/parallel_for.h>

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

// Reorders `depths`.
std::optional<DepthRange> RangeIn(std::vector<float>* depths) {
  if (depths->empty()) return std::nullopt;
  const DepthRange range =
      Widened({kLowerFactor * DepthPercentile(0.01f, depths),
               kUpperFactor * DepthPercentile(0.99f, depths)});
  if (!IsRange(range)) return std::nullopt;
  return range;
}

}  // namespace

std::optional<DepthRange> RangeOfDepths(std::vector<float> depths) {
  return RangeIn(&depths);
}

DepthRanges::DepthRanges(const Workspace& workspace,
                         const TrackIndex& tracks,
                         double given_min,
                         double given_max,
                         std::map<int, DepthRange> given_for,
                         const CancelToken& cancel)
    : given_for_(std::move(given_for)),
      seen_(workspace),
      estimator_(std::make_unique<RangeEstimator>(seen_)) {
  for (auto& [image, range] : given_for_) range = Widened(range);
  ReadTracks(workspace, tracks, cancel);
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

DepthRanges::~DepthRanges() = default;

void DepthRanges::ReadTracks(const Workspace& workspace,
                             const TrackIndex& tracks,
                             const CancelToken& cancel) {
  const SparsePoints& points = workspace.model().points;
  const auto num_images = static_cast<size_t>(workspace.num_images());
  automatic_.resize(num_images);
  std::mutex mutex;
  tbb::enumerable_thread_specific<std::vector<float>> scratch;
  tbb::parallel_for(size_t{0}, num_images, [&](size_t i) {
    cancel.ThrowIfCancelled();
    const int image = static_cast<int>(i);
    std::vector<float>& depths = scratch.local();
    depths.clear();
    if (workspace.usable(image)) {
      const auto visit = [&](size_t point, size_t count) {
        const auto z =
            static_cast<float>(workspace.Depth(image, points[point].xyz));
        if (z > 0 && std::isfinite(z)) depths.insert(depths.end(), count, z);
        return true;
      };
      tracks.ForEachPoint(image, TrackIndex::Reads::kPoints, visit);
    }
    if (depths.size() >= kEnoughPoints) {
      automatic_[i] = RangeIn(&depths);
      return;
    }
    const std::lock_guard<std::mutex> lock(mutex);
    too_few_.emplace(image, depths);
  });
}

std::optional<DepthRange> DepthRanges::ForImage(int image) const {
  if (const DepthRange* given = GivenFor(image)) {
    const DepthRange seen = automatic_[image].value_or(*given);
    return DepthRange{
        std::clamp(seen.min, given->min / kSearchedBeyond, given->min),
        std::clamp(seen.max, given->max, kSearchedBeyond * given->max)};
  }
  if (!IsEstimated(image)) return automatic_[image];
  return estimator_->Estimate(image, too_few_.at(image), automatic_);
}

}  // namespace hpm
