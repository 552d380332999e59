// A fused cloud against a ground-truth cloud. Accuracy: share of estimated
// points nearer than a threshold to the truth. Completeness: the same from the
// truth's side. F1: their harmonic mean. The balanced figures weigh every
// occupied voxel (edge = threshold) alike, so that dense spots do not dominate
// (ETH3D, Schoeps et al. 2017); accuracy counts every point, so the truth must
// cover all that is seen.
#pragma once

#include "src/core/vec.h"

#include <vector>

namespace hpm {

struct CloudScore {
  double threshold = 0;                           // model units
  double accuracy = 0, completeness = 0, f1 = 0;  // 0..1
  double balanced_accuracy = 0, balanced_completeness = 0,
         balanced_f1 = 0;  // 0..1
};

struct CloudEvaluation {
  size_t num_points = 0;
  size_t num_truth_points = 0;
  // Model units.
  double accuracy_mean = 0, accuracy_median = 0;
  double completeness_mean = 0, completeness_median = 0;
  std::vector<CloudScore> scores;  // one per threshold
};

// Points that are not finite are left out. An empty estimate scores 0
// everywhere and has NaN distances. Throws Error(kBadInput) for an empty truth.
CloudEvaluation EvaluateCloud(const std::vector<Vec3f>& estimate,
                              const std::vector<Vec3f>& truth,
                              const std::vector<double>& thresholds);

}  // namespace hpm
