#include "src/prior/triangulation.h"

#include <map>
#include <utility>

#include <opencv2/imgproc.hpp>

namespace hpm {

std::vector<std::array<int, 3>> Triangulate(
    const std::vector<CrediblePoint>& points, int width, int height) {
  std::map<std::pair<int, int>, int> index_of;
  // One pixel of margin: points on the border of the rectangle are refused.
  cv::Subdiv2D subdivision(cv::Rect(-1, -1, width + 2, height + 2));
  for (size_t i = 0; i < points.size(); ++i) {
    const CrediblePoint& p = points[i];
    if (!index_of.emplace(std::make_pair(p.col, p.row), static_cast<int>(i))
             .second)
      continue;
    subdivision.insert(
        cv::Point2f(static_cast<float>(p.col), static_cast<float>(p.row)));
  }
  std::vector<cv::Vec6f> corners;
  if (index_of.size() >= 3) subdivision.getTriangleList(corners);
  std::vector<std::array<int, 3>> triangles;
  for (const cv::Vec6f& c : corners) {
    std::array<int, 3> triangle = {};
    bool inside = true;  // not a corner of the virtual outer triangle
    for (int k = 0; k < 3; ++k) {
      const auto it = index_of.find({cvRound(c[2 * k]), cvRound(c[2 * k + 1])});
      inside = inside && it != index_of.end();
      if (inside) triangle[k] = it->second;
    }
    if (inside) triangles.push_back(triangle);
  }
  return triangles;
}

}  // namespace hpm
