#include "src/image/gaps.h"

#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/image/decode_picture.h"

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
  // OpenCV does not write to it.
  const cv::Mat from(
      mask.height, mask.width, CV_8U, const_cast<uint8_t*>(mask.data.data()));
  cv::Mat resized;
  cv::resize(from, resized, {width, height}, 0, 0, cv::INTER_AREA);
  GrayImage result;
  result.width = width;
  result.height = height;
  result.data.reserve(resized.total());
  for (int row = 0; row < height; ++row) {
    const uint8_t* line = resized.ptr<uint8_t>(row);
    for (int col = 0; col < width; ++col)
      result.data.push_back(line[col] < 128 ? 0 : 255);
  }
  return result;
}

GrayImage LoadMask(const std::filesystem::path& path) {
  cv::Mat image;
  try {
    image = DecodePicture(path,
                          cv::IMREAD_GRAYSCALE | cv::IMREAD_ANYDEPTH |
                              cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const UnreadableFile&) {
    throw;
  } catch (const Error&) {
    throw Error(ErrorCode::kBadInput,
                path.string() +
                    ": this mask cannot be decoded; write it again as PNG, 0 "
                    "where the image is to be ignored");
  }
  GrayImage mask;
  mask.width = image.cols;
  mask.height = image.rows;
  mask.data.resize(image.total());
  cv::Mat to(image.rows, image.cols, CV_8U, mask.data.data());
  cv::compare(image, 0, to, cv::CMP_NE);
  return mask;
}

}  // namespace hpm
