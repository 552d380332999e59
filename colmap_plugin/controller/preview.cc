#include "colmap_plugin/controller/preview.h"

#include "colmap_plugin/formats/atomic_file.h"

#include <algorithm>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

constexpr int kQuality = 92;

std::string EncodeJpeg(const cv::Mat& image, int quality) {
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", image, bytes, {cv::IMWRITE_JPEG_QUALITY, quality});
  return {bytes.begin(), bytes.end()};
}

float Percentile(std::vector<float> values, double share) {
  const auto at =
      values.begin() + static_cast<ptrdiff_t>(share * (values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

cv::Mat ColorDepth(const Map& depth) {
  std::vector<float> inverse;
  for (const float z : depth.data) {
    if (z > 0) inverse.push_back(1 / z);
  }
  cv::Mat color(depth.height, depth.width, CV_8UC3, cv::Scalar::all(0));
  if (inverse.empty()) return color;
  const float far = Percentile(inverse, 0.02);
  const float near = Percentile(inverse, 0.98);
  const float scale = near > far ? 255 / (near - far) : 0;
  cv::Mat level(depth.height, depth.width, CV_8U, cv::Scalar(0));
  cv::Mat valid(depth.height, depth.width, CV_8U, cv::Scalar(0));
  for (int row = 0; row < depth.height; ++row) {
    for (int col = 0; col < depth.width; ++col) {
      const float z = depth.data[static_cast<size_t>(row) * depth.width + col];
      if (!(z > 0)) continue;
      level.at<uint8_t>(row, col) =
          cv::saturate_cast<uint8_t>((1 / z - far) * scale);
      valid.at<uint8_t>(row, col) = 255;
    }
  }
  cv::Mat mapped;
  cv::applyColorMap(level, mapped, cv::COLORMAP_TURBO);
  mapped.copyTo(color, valid);
  return color;
}

cv::Mat ColorNormals(const Map& normal) {
  cv::Mat color(normal.height, normal.width, CV_8UC3, cv::Scalar::all(0));
  const size_t size = static_cast<size_t>(normal.width) * normal.height;
  const auto channel = [](float v) {
    return cv::saturate_cast<uint8_t>(127.5f + 127.5f * v);
  };
  for (int row = 0; row < normal.height; ++row) {
    for (int col = 0; col < normal.width; ++col) {
      const size_t i = static_cast<size_t>(row) * normal.width + col;
      const float x = normal.data[i], y = normal.data[size + i],
                  z = normal.data[2 * size + i];
      if (x == 0 && y == 0 && z == 0) continue;
      color.at<cv::Vec3b>(row, col) = {channel(-z), channel(y), channel(x)};
    }
  }
  return color;
}

}  // namespace

std::string DepthPreview(const Map& depth, int quality) {
  return EncodeJpeg(ColorDepth(depth), quality);
}

std::string ConfidencePreview(const Map& confidence, int quality) {
  const cv::Mat values(confidence.height,
                       confidence.width,
                       CV_32F,
                       const_cast<float*>(confidence.data.data()));
  cv::Mat level, color;
  values.convertTo(level, CV_8U, 255);
  cv::applyColorMap(level, color, cv::COLORMAP_VIRIDIS);
  color.setTo(cv::Scalar::all(0), values == 0);
  return EncodeJpeg(color, quality);
}

std::string NormalPreview(const Map& normal, int quality) {
  return EncodeJpeg(ColorNormals(normal), quality);
}

void WritePreviews(const std::filesystem::path& folder,
                   const std::string& name,
                   const DepthAndNormal& maps) {
  WriteFileAtomically(folder / (name + ".depth.jpg"),
                      DepthPreview(maps.depth, kQuality));
  WriteFileAtomically(folder / (name + ".normal.jpg"),
                      NormalPreview(maps.normal, kQuality));
}

}  // namespace hpm
