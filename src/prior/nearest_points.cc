#include "src/prior/nearest_points.h"

#include <flann/flann.hpp>

namespace hpm {

struct NearestPoints::Index {
  std::vector<float> coordinates;
  flann::Index<flann::L2_Simple<float>> tree;

  explicit Index(std::vector<float> xy)
      : coordinates(std::move(xy)),
        tree(
            flann::Matrix<float>(coordinates.data(), coordinates.size() / 2, 2),
            flann::KDTreeSingleIndexParams()) {
    tree.buildIndex();
  }
};

NearestPoints::NearestPoints(const std::vector<CrediblePoint>& points) {
  std::vector<float> xy;
  for (const CrediblePoint& p : points) {
    xy.push_back(static_cast<float>(p.col));
    xy.push_back(static_cast<float>(p.row));
  }
  index_ = std::make_unique<Index>(std::move(xy));
}

NearestPoints::~NearestPoints() = default;

std::vector<int> NearestPoints::Find(
    const std::vector<float>& queries_col_row) const {
  const size_t num_queries = queries_col_row.size() / 2;
  std::vector<int> indices(num_queries * kNumNearest);
  std::vector<float> distances(num_queries * kNumNearest);
  const flann::Matrix<float> queries(
      const_cast<float*>(queries_col_row.data()), num_queries, 2);
  flann::Matrix<int> result(indices.data(), num_queries, kNumNearest);
  flann::Matrix<float> squared(distances.data(), num_queries, kNumNearest);
  index_->tree.knnSearch(queries,
                         result,
                         squared,
                         kNumNearest,
                         flann::SearchParams(flann::FLANN_CHECKS_UNLIMITED));
  return indices;
}

}  // namespace hpm
