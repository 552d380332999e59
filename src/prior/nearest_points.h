// Exact nearest neighbours among credible points (FLANN KD-tree).
#pragma once

#include "src/prior/credible_points.h"

#include <memory>
#include <vector>

namespace hpm {

constexpr int kNumNearest = 6;  // K of the paper

class NearestPoints {
 public:
  // At least kNumNearest points.
  explicit NearestPoints(const std::vector<CrediblePoint>& points);
  ~NearestPoints();

  // Indices of the kNumNearest points nearest to each query pixel, nearest
  // first; queries and result row by row. Points at the same distance: any
  // order, but always the same.
  std::vector<int> Find(const std::vector<float>& queries_col_row) const;

 private:
  struct Index;
  std::unique_ptr<Index> index_;
};

}  // namespace hpm
