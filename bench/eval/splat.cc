#include "bench/eval/splat.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace hpm {

cv::Mat SplatCloud(const PointCloud& cloud,
                   const Camera& camera,
                   int point_size) {
  cv::Mat picture(
      camera.height, camera.width, CV_8UC3, cv::Scalar(255, 255, 255));
  cv::Mat nearest(camera.height,
                  camera.width,
                  CV_32F,
                  std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < cloud.points.size(); ++i) {
    const Vec3f p = CamFromWorld(camera, cloud.points[i]);
    if (!(p.z > 0)) continue;
    const float x = camera.fx * p.x / p.z + camera.cx -
                    0.5f * static_cast<float>(point_size);
    const float y = camera.fy * p.y / p.z + camera.cy -
                    0.5f * static_cast<float>(point_size);
    if (!(x > -point_size && x < camera.width && y > -point_size &&
          y < camera.height))
      continue;
    const int left = static_cast<int>(std::lround(x));
    const int top = static_cast<int>(std::lround(y));
    cv::Vec3b color(128, 128, 128);
    if (!cloud.colors.empty()) {
      const auto& rgb = cloud.colors[i];
      color = cv::Vec3b(rgb[2], rgb[1], rgb[0]);
    }
    for (int row = std::max(top, 0);
         row < std::min(top + point_size, camera.height);
         ++row) {
      for (int col = std::max(left, 0);
           col < std::min(left + point_size, camera.width);
           ++col) {
        if (p.z >= nearest.at<float>(row, col)) continue;
        nearest.at<float>(row, col) = p.z;
        picture.at<cv::Vec3b>(row, col) = color;
      }
    }
  }
  return picture;
}

}  // namespace hpm
