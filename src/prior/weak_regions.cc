#include "src/prior/weak_regions.h"

#include <opencv2/imgproc.hpp>

namespace hpm {
namespace {

constexpr double kBlur = 1.0;  // pixels

// Of the blurred image, grey levels per pixel.
cv::Mat GradientOf(const cv::Mat& gray) {
  cv::Mat blurred, dx, dy;
  gray.convertTo(blurred, CV_32F);
  cv::GaussianBlur(blurred, blurred, cv::Size(), kBlur);
  cv::Sobel(blurred, dx, CV_32F, 1, 0, 3, 1.0 / 8);
  cv::Sobel(blurred, dy, CV_32F, 0, 1, 3, 1.0 / 8);
  cv::magnitude(dx, dy, dx);
  return dx;
}

}  // namespace

WeakRegions FindWeakRegions(const GrayImage& image,
                            float max_gradient,
                            float min_share) {
  WeakRegions regions;
  regions.width = image.width;
  regions.height = image.height;
  const cv::Mat gray(image.height,
                     image.width,
                     CV_8U,
                     const_cast<uint8_t*>(image.data.data()));
  cv::Mat weak = GradientOf(gray) < max_gradient;
  // Eroded before and grown after the labelling, so that gaps one pixel wide in
  // an edge do not join what lies on its sides.
  const cv::Mat element = cv::getStructuringElement(cv::MORPH_RECT, {3, 3});
  cv::erode(weak, weak, element);
  cv::Mat labels, statistics, centroids;
  const int num_labels = cv::connectedComponentsWithStats(
      weak, labels, statistics, centroids, 4, CV_32S);
  const double min_area = min_share * image.width * image.height;
  std::vector<int> name(num_labels, 0);
  for (int i = 1; i < num_labels; ++i) {
    if (statistics.at<int>(i, cv::CC_STAT_AREA) >= min_area)
      name[i] = ++regions.num_regions;
  }
  cv::Mat kept(image.height, image.width, CV_16U);
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col)
      kept.at<uint16_t>(row, col) =
          static_cast<uint16_t>(name[labels.at<int>(row, col)]);
  }
  labels.release();
  cv::Mat grown;
  cv::dilate(kept, grown, element);
  regions.label.resize(image.data.size());
  for (int row = 0; row < image.height; ++row) {
    for (int col = 0; col < image.width; ++col) {
      const uint16_t own = kept.at<uint16_t>(row, col);
      regions.label[static_cast<size_t>(row) * image.width + col] =
          own > 0 ? own : grown.at<uint16_t>(row, col);
    }
  }
  return regions;
}

}  // namespace hpm
