#include "colmap_plugin/inspect/thumbnails.h"

#include "colmap_plugin/controller/preview.h"
#include "colmap_plugin/workspace/image_size.h"

#include <algorithm>
#include <optional>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

constexpr int kQuality = 65;

// JPEG files are decoded at a reduced scale, others at full size.
int FlagsFor(const std::filesystem::path& path) {
  int flags = cv::IMREAD_COLOR;
  if (const std::optional<ImageSize> size = ReadImageSize(path)) {
    const int times = std::max(size->width, size->height) / kThumbnailSide;
    if (times >= 2) flags = cv::IMREAD_REDUCED_COLOR_2;
    if (times >= 4) flags = cv::IMREAD_REDUCED_COLOR_4;
    if (times >= 8) flags = cv::IMREAD_REDUCED_COLOR_8;
  }
  return flags | cv::IMREAD_IGNORE_ORIENTATION;
}

}  // namespace

Map ReadThinned(const std::filesystem::path& path) {
  const MapReader reader(path);
  const auto [width, height, channels] = reader.header();
  const int step = std::max(
      1, (std::max(width, height) + kThumbnailSide - 1) / kThumbnailSide);
  Map map = {
      (width + step - 1) / step, (height + step - 1) / step, channels, {}};
  map.data.reserve(static_cast<size_t>(map.width) * map.height * channels);
  std::vector<float> line(width);
  for (int channel = 0; channel < channels; ++channel) {
    for (int row = 0; row < map.height; ++row) {
      reader.ReadRows(channel, row * step, 1, line.data());
      for (int col = 0; col < map.width; ++col)
        map.data.push_back(line[static_cast<size_t>(col) * step]);
    }
  }
  return map;
}

std::string DepthThumbnail(const Map& thinned) {
  return DepthPreview(thinned, kQuality);
}

std::string NormalThumbnail(const Map& thinned) {
  return NormalPreview(thinned, kQuality);
}

std::string ConfidenceThumbnail(const Map& thinned) {
  return ConfidencePreview(thinned, kQuality);
}

std::string PictureThumbnail(const std::filesystem::path& path) {
  cv::Mat image;
  std::vector<unsigned char> bytes;
  try {
    image = cv::imread(path.string(), FlagsFor(path));
    if (image.empty()) return "";
    const double scale =
        static_cast<double>(kThumbnailSide) / std::max(image.cols, image.rows);
    cv::Mat small;
    if (scale < 1) {
      cv::resize(image, small, {}, scale, scale, cv::INTER_AREA);
    } else {
      small = image;
    }
    cv::imencode(".jpg", small, bytes, {cv::IMWRITE_JPEG_QUALITY, kQuality});
  } catch (const cv::Exception&) {
    return "";
  }
  return {bytes.begin(), bytes.end()};
}

}  // namespace hpm
