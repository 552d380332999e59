#include "colmap_plugin/workspace/source_selection.h"

#include <algorithm>
#include <cmath>
#include <functional>

namespace hpm {
namespace {

constexpr double kPi = 3.14159265358979323846;

// The angle a between two rays enters as min(a, pi - a), whose cosine is |cos
// a|; it falls with the angle, so the percentile is taken of cosines and only
// one arc cosine per image pair is needed.
struct SharedPoint {
  double abs_cos;
  uint64_t weight;  // how often the reference occurs in the track
};

double AbsCosOfAngle(const Eigen::Vector3d& point,
                     const Eigen::Vector3d& center1,
                     const Eigen::Vector3d& center2) {
  const Eigen::Vector3d ray1 = center1 - point;
  const Eigen::Vector3d ray2 = center2 - point;
  const double length_product =
      std::sqrt(ray1.squaredNorm() * ray2.squaredNorm());
  if (!(length_product > 0)) return 1;
  return std::min(1.0, std::abs(ray1.dot(ray2)) / length_product);
}

// Nearest rank, as COLMAP 3.8: element round(0.75 (n - 1)) of the n ascending
// angles.
float AnglePercentile(uint64_t num_shared, std::vector<SharedPoint>* shared) {
  const auto larger_angle_last = [](const SharedPoint& a,
                                    const SharedPoint& b) {
    return a.abs_cos > b.abs_cos;
  };
  const auto rank = static_cast<uint64_t>(
      std::round(0.75 * static_cast<double>(num_shared - 1)));
  auto it = shared->begin();
  if (num_shared == shared->size()) {
    it += static_cast<std::ptrdiff_t>(rank);
    std::nth_element(shared->begin(), it, shared->end(), larger_angle_last);
  } else {
    std::sort(shared->begin(), shared->end(), larger_angle_last);
    uint64_t num_before = it->weight;
    while (num_before <= rank && std::next(it) != shared->end())
      num_before += (++it)->weight;
  }
  return static_cast<float>(std::acos(it->abs_cos));
}

}  // namespace

SourceSelector::SourceSelector(const Workspace& workspace)
    : workspace_(workspace), begin_(workspace.num_images() + 1, 0) {
  const std::vector<SparsePoint>& points = workspace.model().points;
  std::vector<size_t> last_point(workspace.num_images(), points.size());
  const auto for_each_image_of_point = [&](const auto& visit) {
    std::fill(last_point.begin(), last_point.end(), points.size());
    for (size_t point = 0; point < points.size(); ++point) {
      if (!points[point].xyz.cast<float>().allFinite()) continue;
      for (const int image : points[point].track) {
        if (last_point[image] == point) continue;
        last_point[image] = point;
        visit(image, static_cast<uint32_t>(point));
      }
    }
  };
  for_each_image_of_point([&](int image, uint32_t) { ++begin_[image + 1]; });
  for (size_t i = 1; i < begin_.size(); ++i) begin_[i] += begin_[i - 1];
  points_.resize(begin_.back());
  std::vector<size_t> end(begin_.begin(), begin_.end() - 1);
  for_each_image_of_point(
      [&](int image, uint32_t point) { points_[end[image]++] = point; });
}

std::vector<SourceCandidate> SourceSelector::Candidates(int ref_image) const {
  std::vector<SourceCandidate> candidates;
  if (!workspace_.usable(ref_image)) return candidates;
  std::vector<std::vector<SharedPoint>> shared(workspace_.num_images());
  std::vector<uint64_t> num_shared(workspace_.num_images(), 0);
  for (size_t k = begin_[ref_image]; k < begin_[ref_image + 1]; ++k) {
    const SparsePoint& point = workspace_.model().points[points_[k]];
    const auto weight = static_cast<uint64_t>(
        std::count(point.track.begin(), point.track.end(), ref_image));
    for (const int image : point.track) {
      if (image == ref_image || !workspace_.usable(image)) continue;
      shared[image].push_back({AbsCosOfAngle(point.xyz,
                                             workspace_.Center(ref_image),
                                             workspace_.Center(image)),
                               weight});
      num_shared[image] += weight;
    }
  }
  for (int image = 0; image < workspace_.num_images(); ++image) {
    if (shared[image].empty()) continue;
    candidates.push_back({image,
                          num_shared[image],
                          AnglePercentile(num_shared[image], &shared[image])});
  }
  std::stable_sort(candidates.begin(),
                   candidates.end(),
                   [](const SourceCandidate& a, const SourceCandidate& b) {
                     return a.num_shared > b.num_shared;
                   });
  return candidates;
}

size_t SourceSelector::NumSharedPoints(int ref_image) const {
  size_t num_shared = 0;
  for (size_t k = begin_[ref_image]; k < begin_[ref_image + 1]; ++k) {
    const std::vector<int>& track = workspace_.model().points[points_[k]].track;
    num_shared += std::any_of(track.begin(), track.end(), [&](int image) {
      return image != ref_image && workspace_.usable(image);
    });
  }
  return num_shared;
}

std::vector<int> SourceSelector::Select(int ref_image,
                                        double min_angle,
                                        int max_num) const {
  const auto min_radians = static_cast<float>(min_angle * kPi / 180);
  std::vector<int> images;
  for (const SourceCandidate& candidate : Candidates(ref_image)) {
    if (max_num >= 0 && images.size() >= static_cast<size_t>(max_num)) break;
    if (candidate.angle >= min_radians) images.push_back(candidate.image);
  }
  return images;
}

}  // namespace hpm
