#include "src/image/gaps.h"

#include "src/base/error.h"

#include <algorithm>
#include <cstddef>
#include <vector>

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

GrayImage BlackBorder(const GrayImage& image) {
  constexpr size_t kLeastShare = 1000;
  const int width = image.width, height = image.height;
  std::vector<uint8_t> reached(image.data.size(), 0);
  std::vector<size_t> open;
  const auto reach = [&](int col, int row) {
    const size_t at = static_cast<size_t>(row) * width + col;
    if (image.data[at] != 0 || reached[at] != 0) return;
    reached[at] = 1;
    open.push_back(at);
  };
  for (int col = 0; col < width; ++col) {
    reach(col, 0);
    reach(col, height - 1);
  }
  for (int row = 0; row < height; ++row) {
    reach(0, row);
    reach(width - 1, row);
  }
  size_t num_reached = 0;
  while (!open.empty()) {
    const size_t at = open.back();
    open.pop_back();
    ++num_reached;
    const int col = static_cast<int>(at % width);
    const int row = static_cast<int>(at / width);
    if (col > 0) reach(col - 1, row);
    if (row > 0) reach(col, row - 1);
    if (col + 1 < width) reach(col + 1, row);
    if (row + 1 < height) reach(col, row + 1);
  }
  if (num_reached * kLeastShare <= image.data.size()) return {};
  GrayImage mask;
  mask.width = width;
  mask.height = height;
  mask.data.resize(reached.size());
  for (size_t i = 0; i < reached.size(); ++i)
    mask.data[i] = reached[i] != 0 ? 0 : 255;
  return mask;
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
