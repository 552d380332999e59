#include "src/prior/nearest_points.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(NearestPoints, AgreeWithBruteForceInDistance) {
  std::mt19937 random(3);
  std::vector<CrediblePoint> points;
  for (int i = 0; i < 200; ++i) {
    points.push_back({static_cast<int>(random() % 90),
                      static_cast<int>(random() % 70),
                      {0, 0, 1}});
  }
  std::vector<float> queries;
  for (int i = 0; i < 100; ++i) {
    queries.push_back(static_cast<float>(random() % 90));
    queries.push_back(static_cast<float>(random() % 70));
  }
  const std::vector<int> found = NearestPoints(points).Find(queries);
  for (int q = 0; q < 100; ++q) {
    const auto squared = [&](const CrediblePoint& p) {
      const float dx = static_cast<float>(p.col) - queries[2 * q];
      const float dy = static_cast<float>(p.row) - queries[2 * q + 1];
      return dx * dx + dy * dy;
    };
    std::vector<float> all;
    for (const CrediblePoint& p : points) all.push_back(squared(p));
    std::sort(all.begin(), all.end());
    for (int k = 0; k < kNumNearest; ++k) {
      EXPECT_EQ(squared(points[found[q * kNumNearest + k]]), all[k]);
    }
  }
}

}  // namespace
}  // namespace hpm
