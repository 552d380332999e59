#include "colmap_plugin/workspace/overlap_selection.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace hpm {
namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;
// Of the reference; fewer if they are projected into thousands of images.
size_t MaxPoints(int num_images) {
  return std::clamp<size_t>(
      100000 / static_cast<size_t>(std::max(1, num_images)), 50, 250);
}
// Images that share less than this part of the reference help it little.
constexpr double kMinShare = 0.05;

}  // namespace

OverlapSelector::OverlapSelector(const SeenPoints& seen)
    : seen_(seen), views_(seen.views()) {}

std::vector<int> OverlapSelector::Select(
    int ref_image,
    const DepthRange& range,
    double min_angle,
    const std::vector<int>& candidates) const {
  std::vector<int> images;
  for (const int image : candidates) {
    if (image != ref_image && views_.usable(image)) images.push_back(image);
  }
  if (images.empty()) return images;
  const std::vector<Eigen::Vector3d> points = PointsOf(ref_image, range);
  std::vector<std::pair<double, int>> scores;
  std::vector<double> angles;
  for (const int image : images) {
    double score = 0;
    angles.clear();
    for (const Eigen::Vector3d& point : points) {
      if (!views_.Project(image, point)) continue;
      const double angle =
          AngleAt(point, views_.center(ref_image), views_.center(image));
      const double weight = ParallaxWeight(angle);
      if (weight <= 0) continue;
      score += weight;
      angles.push_back(angle);
    }
    if (angles.empty() || static_cast<double>(angles.size()) <
                              kMinShare * static_cast<double>(points.size())) {
      continue;
    }
    const auto quarter = angles.begin() + static_cast<std::ptrdiff_t>(
                                              3 * (angles.size() - 1) / 4);
    std::nth_element(angles.begin(), quarter, angles.end());
    if (*quarter >= min_angle * kDegree) scores.emplace_back(score, image);
  }
  std::stable_sort(
      scores.begin(), scores.end(), [](const auto& a, const auto& b) {
        return a.first > b.first;
      });
  images.clear();
  for (const auto& [score, image] : scores) images.push_back(image);
  return images;
}

std::vector<Eigen::Vector3d> OverlapSelector::PointsOf(
    int image, const DepthRange& range) const {
  std::vector<Eigen::Vector3d> points;
  for (const SeenPoints::SeenPoint& seen : seen_.ForImage(image))
    points.push_back(seen.xyz);
  if (points.size() < kEnoughPoints) {
    points.clear();
    constexpr int kNumDepths = 8;
    for (int i = 0; i < kNumDepths; ++i) {
      const double depth =
          range.min * std::pow(range.max / range.min, (i + 0.5) / kNumDepths);
      for (const Eigen::Vector3d& point : views_.GridAt(image, depth))
        points.push_back(point);
    }
  }
  size_t step = points.size() / MaxPoints(views_.size()) + 1;
  if (step % 5 == 0) ++step;  // else one column of the 5x5 grid stands for all
  std::vector<Eigen::Vector3d> some;
  for (size_t i = 0; i < points.size(); i += step) some.push_back(points[i]);
  return some;
}

}  // namespace hpm
