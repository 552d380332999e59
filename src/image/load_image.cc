#include "src/image/load_image.h"

#include "src/base/error.h"
#include "src/image/decode_picture.h"
#include "src/image/gaps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

int FlagsFor(int reduction) {
  int flags = cv::IMREAD_COLOR;
  if (reduction == 2) flags = cv::IMREAD_REDUCED_COLOR_2;
  if (reduction == 4) flags = cv::IMREAD_REDUCED_COLOR_4;
  if (reduction == 8) flags = cv::IMREAD_REDUCED_COLOR_8;
  return flags | cv::IMREAD_IGNORE_ORIENTATION;
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
      const float half_above =
          0.0722f * p[0] + 0.7152f * p[1] + 0.2126f * p[2] + 0.5f;
      gray.data[i++] = static_cast<uint8_t>(half_above);
    }
  }
  return gray;
}

// Samples of any kind, with the same weights; 0 where there is no value.
cv::Mat DecodeDeep(const std::filesystem::path& path) {
  const cv::Mat image = DecodePicture(path, cv::IMREAD_UNCHANGED);
  const int num_channels = image.channels();
  cv::Mat gray(image.rows, image.cols, CV_32F);
  cv::Mat samples;
  for (int row = 0; row < image.rows; ++row) {
    image.row(row).convertTo(samples, CV_32F);
    const float* p = samples.ptr<float>();
    float* to = gray.ptr<float>(row);
    for (int col = 0; col < image.cols; ++col, p += num_channels) {
      const float value =
          num_channels < 3 ? p[0]
                           : 0.0722f * p[0] + 0.7152f * p[1] + 0.2126f * p[2];
      to[col] = std::isfinite(value) ? value : 0;
    }
  }
  return gray;
}

GrayImage Stretch(const cv::Mat& deep, const GreyRange& range) {
  GrayImage gray;
  gray.width = deep.cols;
  gray.height = deep.rows;
  gray.data.reserve(deep.total());
  const double scale = 254 / std::max(range.high - range.low, 1e-30);
  for (int row = 0; row < deep.rows; ++row) {
    const float* p = deep.ptr<float>(row);
    for (int col = 0; col < deep.cols; ++col) {
      const double value = 1.5 + (p[col] - range.low) * scale;
      gray.data.push_back(
          p[col] == 0 ? 0 : static_cast<uint8_t>(std::clamp(value, 1., 255.)));
    }
  }
  return gray;
}

GrayImage Resize(const GrayImage& gray, int width, int height) {
  // OpenCV does not write to it.
  const cv::Mat from(
      gray.height, gray.width, CV_8U, const_cast<uint8_t*>(gray.data.data()));
  GrayImage resized;
  resized.width = width;
  resized.height = height;
  resized.data.resize(static_cast<size_t>(width) * height);
  cv::Mat to(height, width, CV_8U, resized.data.data());
  cv::resize(from, to, to.size(), 0, 0, cv::INTER_AREA);
  return resized;
}

// How much each pixel of a row or column counts for a pixel of a smaller one.
struct Share {
  int first = 0;
  std::vector<double> weights;  // their sum is 1
};

// Adds `factor` times the sum of all pixels before `position` of a row of
// `count` pixels: exact between pixels, within one a cubic (Catmull-Rom)
// through the sums around it. Differences of it are means that neither blur nor
// shift where pixels are cut. Pixels before the share's first count as if there
// were none.
void AddSumBefore(double position, int count, double factor, Share* share) {
  const int k = std::min(static_cast<int>(position), count);
  const double t = position - k;
  const double sums[] = {(-t + 2 * t * t - t * t * t) / 2,
                         (2 - 5 * t * t + 3 * t * t * t) / 2,
                         (t + 4 * t * t - 3 * t * t * t) / 2,
                         (-t * t + t * t * t) / 2};
  const auto add = [&](int pixel, double weight) {
    // Beyond the border its pixel goes on.
    const int at = std::clamp(pixel, 0, count - 1) - share->first;
    if (at >= 0) share->weights[at] += factor * weight;
  };
  for (int j = 0; j < 4; ++j) {
    const int end = k - 1 + j;
    if (end < 0) add(0, -sums[j]);
    for (int pixel = share->first; pixel < end; ++pixel) add(pixel, sums[j]);
  }
}

// `extent`: how much of the `count` pixels the smaller row covers; the decoder
// fills its last pixel up where the file's size is no multiple.
std::vector<Share> SharesOf(double extent, int count, int small_count) {
  std::vector<Share> shares(small_count);
  const double step = extent / small_count;
  for (int i = 0; i < small_count; ++i) {
    const double begin = i * step;
    const double end = begin + step;
    Share& share = shares[i];
    share.first = std::max(static_cast<int>(begin) - 1, 0);
    const int last = std::min(static_cast<int>(end) + 1, count - 1);
    share.weights.resize(last - share.first + 1);
    AddSumBefore(end, count, 1 / step, &share);
    AddSumBefore(begin, count, -1 / step, &share);
  }
  return shares;
}

GrayImage ShrinkToExtent(const GrayImage& gray,
                         double extent_x,
                         double extent_y,
                         int width,
                         int height) {
  const std::vector<Share> columns = SharesOf(extent_x, gray.width, width);
  const std::vector<Share> rows = SharesOf(extent_y, gray.height, height);
  GrayImage result;
  result.width = width;
  result.height = height;
  result.data.reserve(static_cast<size_t>(width) * height);
  std::vector<double> line(gray.width);
  for (const Share& row : rows) {
    std::fill(line.begin(), line.end(), 0.);
    for (size_t r = 0; r < row.weights.size(); ++r) {
      const int y = row.first + static_cast<int>(r);
      const uint8_t* from = &gray.data[static_cast<size_t>(y) * gray.width];
      for (int x = 0; x < gray.width; ++x) line[x] += row.weights[r] * from[x];
    }
    for (const Share& column : columns) {
      double sum = 0.5;
      for (size_t c = 0; c < column.weights.size(); ++c)
        sum += column.weights[c] * line[column.first + c];
      result.data.push_back(static_cast<uint8_t>(std::clamp(sum, 0., 255.)));
    }
  }
  return result;
}

GrayImage Load(const std::filesystem::path& path,
               int width,
               int height,
               const ImageDecoding& decoding) {
  if (decoding.stretch) {
    const cv::Mat deep = DecodeDeep(path);
    if (deep.cols == width && deep.rows == height)
      return Stretch(deep, *decoding.stretch);
    cv::Mat resized;
    cv::resize(deep, resized, {width, height}, 0, 0, cv::INTER_AREA);
    return Stretch(resized, *decoding.stretch);
  }
  GrayImage gray = ToGray(DecodePicture(path, FlagsFor(decoding.reduction)));
  if (decoding.reduction == 1) {
    if (gray.width == width && gray.height == height) return gray;
    return Resize(gray, width, height);
  }
  const auto extent = [&](int file_side, int decoded_side) {
    const int rounded_up =
        (file_side + decoding.reduction - 1) / decoding.reduction;
    return rounded_up == decoded_side
               ? file_side / static_cast<double>(decoding.reduction)
               : decoded_side;  // another file than was asked for
  };
  return ShrinkToExtent(gray,
                        extent(decoding.file_width, gray.width),
                        extent(decoding.file_height, gray.height),
                        width,
                        height);
}

}  // namespace

int ReductionFor(int file_width, int file_height, int width, int height) {
  // At half size the decoder keeps all that half a size can hold. Beyond, it
  // averages blocks, of which several per pixel must be left to resample.
  constexpr int kBlocksPerPixel = 4;
  const auto leaves = [&](int reduction, int times) {
    return file_width / reduction >= times * width &&
           file_height / reduction >= times * height;
  };
  for (const int reduction : {8, 4}) {
    if (leaves(reduction, kBlocksPerPixel)) return reduction;
  }
  return leaves(2, 1) ? 2 : 1;
}

GrayImage LoadGrayImage(const std::filesystem::path& path,
                        int width,
                        int height,
                        const ImageDecoding& decoding) {
  GrayImage image = Load(path, width, height, decoding);
  if (decoding.mask.empty()) return image;
  ApplyMask(ResizedMask(LoadMask(decoding.mask), width, height), &image);
  return image;
}

std::optional<GreyRange> MeasureGreyRange(const std::filesystem::path& path) {
  constexpr size_t kEnoughPixels = 1 << 20;
  constexpr double kBeyond = 0.001;
  cv::Mat deep;
  try {
    deep = DecodeDeep(path);
  } catch (const Error&) {
    return std::nullopt;
  }
  std::vector<float> values;
  const size_t step = deep.total() / kEnoughPixels + 1;
  for (size_t i = 0; i < deep.total(); i += step) {
    const float value = deep.ptr<float>()[i];
    if (value != 0) values.push_back(value);
  }
  if (values.empty()) return std::nullopt;
  const auto beyond =
      static_cast<ptrdiff_t>(kBeyond * static_cast<double>(values.size()));
  const auto value_at = [&](ptrdiff_t rank) {
    std::nth_element(values.begin(), values.begin() + rank, values.end());
    return values[rank];
  };
  return GreyRange{
      value_at(beyond),
      value_at(static_cast<ptrdiff_t>(values.size()) - 1 - beyond)};
}

}  // namespace hpm
