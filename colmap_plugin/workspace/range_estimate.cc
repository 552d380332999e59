#include "colmap_plugin/workspace/range_estimate.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hpm {
namespace {

// The range ends where so much of the best depth's support is left. Of a dozen
// scenes it holds 99.9 % of what the tracks say. More is asked of far depths:
// they are searched evenly, so that far ones take the most trials.
constexpr double kNearSupport = 0.1;
constexpr double kFarSupport = 0.3;
// Of images that are compared with one.
constexpr size_t kMaxOthers = 40;
// Between the distances of cameras, and the depths tried, each a seventh beyond
// the one before at most.
constexpr double kMaxSpread = 1000;
constexpr int kNumDepths = 150;

// `count` steps by equal factors, both ends included.
std::vector<double> Geometric(double from, double to, int count) {
  std::vector<double> values;
  values.reserve(count);
  for (int i = 0; i < count; ++i)
    values.push_back(from * std::pow(to / from, i / (count - 1.0)));
  return values;
}

std::optional<DepthRange> Joined(const std::optional<DepthRange>& a,
                                 const std::optional<DepthRange>& b) {
  if (!a || !b) return a ? a : b;
  return DepthRange{std::min(a->min, b->min), std::max(a->max, b->max)};
}

}  // namespace

RangeEstimator::RangeEstimator(const SeenPoints& seen)
    : seen_(seen), views_(seen.views()) {}

std::optional<DepthRange> RangeEstimator::Estimate(
    int image,
    const std::vector<float>& tracked,
    const std::vector<std::optional<DepthRange>>& known) const {
  if (!views_.usable(image)) return std::nullopt;
  std::vector<float> depths = SeenDepths(image);
  depths.insert(depths.end(), tracked.begin(), tracked.end());
  if (depths.size() < kEnoughPoints) {
    const std::vector<float> more = DepthsOfNeighbours(image, known);
    depths.insert(depths.end(), more.begin(), more.end());
  }
  const bool is_enough = depths.size() >= kEnoughPoints || !tracked.empty();
  // Of many points a few at the ends are cut off as outliers; but those of
  // tracks are few and matched.
  const std::optional<DepthRange> range =
      Joined(RangeOfDepths(std::move(depths)), RangeOfDepths(tracked));
  return is_enough ? range : Joined(range, RangeOfParallax(image));
}

std::vector<float> RangeEstimator::SeenDepths(int image) const {
  std::vector<float> depths;
  for (const SeenPoints::SeenPoint& point : seen_.ForImage(image))
    depths.push_back(static_cast<float>(point.depth));
  return depths;
}

std::optional<DepthRange> RangeEstimator::RangeOfSeenPoints(int image) const {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto entry = seen_ranges_.find(image);
    if (entry != seen_ranges_.end()) return entry->second;
  }
  // Whoever asks meanwhile finds the same.
  std::optional<DepthRange> range;
  std::vector<float> depths = SeenDepths(image);
  if (depths.size() >= kEnoughPoints) range = RangeOfDepths(std::move(depths));
  const std::lock_guard<std::mutex> lock(mutex_);
  return seen_ranges_.emplace(image, range).first->second;
}

// From near to far; of many, at most kMaxOthers of all distances.
std::vector<int> RangeEstimator::SomeOthers(int image) const {
  std::vector<std::pair<double, int>> others;
  for (int i = 0; i < views_.size(); ++i) {
    const double distance = (views_.center(i) - views_.center(image)).norm();
    if (views_.usable(i) && distance > 0) others.emplace_back(distance, i);
  }
  std::sort(others.begin(), others.end());
  const size_t step = (others.size() + kMaxOthers - 1) / kMaxOthers;
  std::vector<int> some;
  for (size_t i = 0; i < others.size(); i += step)
    some.push_back(others[i].second);
  return some;
}

std::vector<float> RangeEstimator::DepthsOfNeighbours(
    int image, const std::vector<std::optional<DepthRange>>& known) const {
  std::vector<float> depths;
  for (const int other : SomeOthers(image)) {
    const std::optional<DepthRange> range =
        known[other] ? known[other] : RangeOfSeenPoints(other);
    if (!range) continue;
    for (const double depth : Geometric(range->min, range->max, 5)) {
      for (const Eigen::Vector3d& point : views_.GridAt(other, depth)) {
        const auto projection = views_.Project(image, point);
        if (projection) depths.push_back(static_cast<float>(projection->depth));
      }
    }
  }
  return depths;
}

std::optional<DepthRange> RangeEstimator::RangeOfParallax(int image) const {
  const std::vector<int> others = SomeOthers(image);
  if (others.empty()) return std::nullopt;
  const Eigen::Vector3d& center = views_.center(image);
  const auto distance = [&](int other) {
    return (views_.center(other) - center).norm();
  };
  // Twins and strays do not count.
  const double median = distance(others[others.size() / 2]);
  const double nearest =
      std::max(distance(others.front()), median / kMaxSpread);
  const double farthest =
      std::min(distance(others.back()), median * kMaxSpread);
  // Nearer, views look too different; farther, they have no parallax.
  const std::vector<double> depths =
      Geometric(nearest / 4, farthest / kMinParallax, kNumDepths);
  std::vector<double> support;
  support.reserve(depths.size());
  for (const double depth : depths)
    support.push_back(Support(image, others, depth));
  const double best = *std::max_element(support.begin(), support.end());
  if (!(best > 0)) return std::nullopt;
  size_t near = 0;
  while (support[near] < kNearSupport * best) ++near;
  size_t far = depths.size() - 1;
  while (support[far] < kFarSupport * best) --far;
  return RangeOfDepths(
      {static_cast<float>(depths[near]), static_cast<float>(depths[far])});
}

double RangeEstimator::Support(int image,
                               const std::vector<int>& others,
                               double depth) const {
  double support = 0;
  for (const Eigen::Vector3d& point : views_.GridAt(image, depth)) {
    for (const int other : others) {
      if (!views_.Project(other, point)) continue;
      const double angle =
          AngleAt(point, views_.center(image), views_.center(other));
      if (angle >= kMinParallax) support += ParallaxWeight(angle);
    }
  }
  return support;
}

}  // namespace hpm
