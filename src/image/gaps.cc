#include "src/image/gaps.h"

#include "src/base/error.h"

#include <algorithm>
#include <cstddef>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {

void ApplyMask(const GrayImage& mask, GrayImage* image) {
  if (std::find(mask.data.begin(), mask.data.end(), 0) == mask.data.end())
    return;
  image->has_gaps = true;
  for (size_t i = 0; i < image->data.size(); ++i) {
    image->data[i] =
        mask.data[i] == 0 ? 0 : std::max<uint8_t>(image->data[i], 1);
  }
}

GrayImage ResizedMask(const GrayImage& mask, int width, int height) {
  if (mask.width == width && mask.height == height) return mask;
  cv::Mat shown(mask.height, mask.width, CV_8U);
  std::transform(mask.data.begin(),
                 mask.data.end(),
                 shown.ptr<uint8_t>(),
                 [](uint8_t value) { return value == 0 ? 0 : 255; });
  cv::Mat resized;
  cv::resize(shown, resized, {width, height}, 0, 0, cv::INTER_AREA);
  GrayImage result;
  result.width = width;
  result.height = height;
  result.data.reserve(resized.total());
  for (int row = 0; row < height; ++row) {
    const uint8_t* from = resized.ptr<uint8_t>(row);
    for (int col = 0; col < width; ++col)
      result.data.push_back(from[col] < 128 ? 0 : 255);
  }
  return result;
}

GrayImage LoadMask(const std::filesystem::path& path) {
  cv::Mat image;
  try {
    image = cv::imread(path.string(),
                       cv::IMREAD_GRAYSCALE | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.empty()) {
    throw Error(ErrorCode::kBadInput,
                path.string() +
                    ": this mask cannot be decoded; write it again as PNG, 0 "
                    "where the image is to be ignored");
  }
  GrayImage mask;
  mask.width = image.cols;
  mask.height = image.rows;
  mask.data.reserve(image.total());
  for (int row = 0; row < image.rows; ++row) {
    const uint8_t* from = image.ptr<uint8_t>(row);
    mask.data.insert(mask.data.end(), from, from + image.cols);
  }
  return mask;
}

}  // namespace hpm
