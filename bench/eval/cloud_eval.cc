#include "bench/eval/cloud_eval.h"

#include "bench/eval/statistics.h"
#include "src/base/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <thread>

#include <flann/flann.hpp>

namespace hpm {
namespace {

std::vector<Vec3f> FinitePoints(const std::vector<Vec3f>& points) {
  std::vector<Vec3f> finite;
  finite.reserve(points.size());
  for (const Vec3f& p : points) {
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z))
      finite.push_back(p);
  }
  return finite;
}

flann::Matrix<float> AsMatrix(const std::vector<Vec3f>& points,
                              size_t begin,
                              size_t end) {
  // FLANN's matrices are views without const.
  return flann::Matrix<float>(
      const_cast<float*>(&points[begin].x), end - begin, 3);
}

// Distance of each point to the nearest of `targets`, both not empty.
std::vector<float> NearestDistances(const std::vector<Vec3f>& points,
                                    const std::vector<Vec3f>& targets) {
  flann::Index<flann::L2_Simple<float>> index(
      AsMatrix(targets, 0, targets.size()), flann::KDTreeSingleIndexParams(16));
  index.buildIndex();
  std::vector<int> neighbors(points.size());
  std::vector<float> distances(points.size());
  const auto search = [&](size_t begin, size_t end) {
    if (begin == end) return;
    flann::Matrix<int> found(&neighbors[begin], end - begin, 1);
    flann::Matrix<float> squared(&distances[begin], end - begin, 1);
    index.knnSearch(AsMatrix(points, begin, end),
                    found,
                    squared,
                    1,
                    flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  };
  const size_t half = points.size() / 2;
  std::thread other(search, 0, half);
  search(half, points.size());
  other.join();
  for (float& d : distances) d = std::sqrt(d);
  return distances;
}

double ShareBelow(const std::vector<float>& distances, double threshold) {
  const auto count =
      std::count_if(distances.begin(), distances.end(), [threshold](float d) {
        return d < threshold;
      });
  return static_cast<double>(count) / static_cast<double>(distances.size());
}

// Mean over the occupied voxels of the share of their points below the
// threshold.
double BalancedShareBelow(const std::vector<Vec3f>& points,
                          const std::vector<float>& distances,
                          double threshold) {
  using Voxel = std::array<double, 3>;
  std::vector<std::pair<Voxel, bool>> entries(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3f& p = points[i];
    entries[i] = {{std::floor(p.x / threshold),
                   std::floor(p.y / threshold),
                   std::floor(p.z / threshold)},
                  distances[i] < threshold};
  }
  std::sort(entries.begin(), entries.end());
  double sum = 0;
  size_t num_voxels = 0;
  for (size_t i = 0; i < entries.size();) {
    size_t end = i;
    size_t below = 0;
    for (; end < entries.size() && entries[end].first == entries[i].first;
         ++end) {
      below += entries[end].second ? 1 : 0;
    }
    sum += static_cast<double>(below) / static_cast<double>(end - i);
    ++num_voxels;
    i = end;
  }
  return sum / static_cast<double>(num_voxels);
}

double F1(double accuracy, double completeness) {
  const double sum = accuracy + completeness;
  return sum > 0 ? 2 * accuracy * completeness / sum : 0;
}

double Mean(const std::vector<float>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(values.size());
}

}  // namespace

CloudEvaluation EvaluateCloud(const std::vector<Vec3f>& estimate_points,
                              const std::vector<Vec3f>& truth_points,
                              const std::vector<double>& thresholds) {
  for (const double threshold : thresholds) {
    if (!(threshold > 0))
      throw Error(ErrorCode::kUsage, "cloud thresholds must be positive");
  }
  const std::vector<Vec3f> estimate = FinitePoints(estimate_points);
  const std::vector<Vec3f> truth = FinitePoints(truth_points);
  if (truth.empty())
    throw Error(ErrorCode::kBadInput, "the ground-truth cloud has no points");
  CloudEvaluation result;
  result.num_points = estimate.size();
  result.num_truth_points = truth.size();
  if (estimate.empty()) {
    result.accuracy_mean = result.accuracy_median = result.completeness_mean =
        result.completeness_median = std::numeric_limits<double>::quiet_NaN();
    for (const double threshold : thresholds)
      result.scores.push_back({threshold});
    return result;
  }
  const std::vector<float> to_truth = NearestDistances(estimate, truth);
  const std::vector<float> to_estimate = NearestDistances(truth, estimate);
  result.accuracy_mean = Mean(to_truth);
  result.accuracy_median = Median(to_truth);
  result.completeness_mean = Mean(to_estimate);
  result.completeness_median = Median(to_estimate);
  for (const double threshold : thresholds) {
    CloudScore score;
    score.threshold = threshold;
    score.accuracy = ShareBelow(to_truth, threshold);
    score.completeness = ShareBelow(to_estimate, threshold);
    score.f1 = F1(score.accuracy, score.completeness);
    score.balanced_accuracy = BalancedShareBelow(estimate, to_truth, threshold);
    score.balanced_completeness =
        BalancedShareBelow(truth, to_estimate, threshold);
    score.balanced_f1 =
        F1(score.balanced_accuracy, score.balanced_completeness);
    result.scores.push_back(score);
  }
  return result;
}

}  // namespace hpm
