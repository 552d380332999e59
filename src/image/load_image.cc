#include "src/image/load_image.h"

#include "src/base/error.h"

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

cv::Mat Decode(const std::filesystem::path& path) {
  // OpenCV refuses more than 2^30 pixels by itself, from the header.
  cv::Mat image;
  try {
    image = cv::imread(path.string(),
                       cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& e) {
    throw Error(ErrorCode::kBadInput,
                path.string() + ": cannot be decoded (" + e.err + ")");
  }
  if (image.empty()) {
    throw Error(
        ErrorCode::kBadInput,
        path.string() +
            ": missing or not a readable image; undistort the images again");
  }
  return image;
}

// Weights of BT.709, rounded, as COLMAP's bitmap conversion.
GrayImage ToGray(const cv::Mat& bgr) {
  GrayImage gray;
  gray.width = bgr.cols;
  gray.height = bgr.rows;
  gray.data.resize(static_cast<size_t>(bgr.cols) * bgr.rows);
  size_t i = 0;
  for (int row = 0; row < bgr.rows; ++row) {
    const uint8_t* p = bgr.ptr<uint8_t>(row);
    for (int col = 0; col < bgr.cols; ++col, p += 3) {
      gray.data[i++] = static_cast<uint8_t>(0.0722f * p[0] + 0.7152f * p[1] +
                                            0.2126f * p[2] + 0.5f);
    }
  }
  return gray;
}

}  // namespace

GrayImage LoadGrayImage(const std::filesystem::path& path,
                        int width,
                        int height) {
  GrayImage gray = ToGray(Decode(path));
  if (gray.width == width && gray.height == height) return gray;
  const cv::Mat from(gray.height, gray.width, CV_8U, gray.data.data());
  GrayImage resized;
  resized.width = width;
  resized.height = height;
  resized.data.resize(static_cast<size_t>(width) * height);
  cv::Mat to(height, width, CV_8U, resized.data.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return resized;
}

}  // namespace hpm
