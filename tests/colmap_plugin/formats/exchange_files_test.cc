#include "colmap_plugin/formats/exchange_files.h"

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

// Values that show any change of order, and that only 32 bits hold.
Map SomeMap(int channels) {
  Map map = {7, 5, channels, {}};
  for (int i = 0; i < 35 * channels; ++i)
    map.data.push_back(1e-3f / 3 + static_cast<float>(i * i) / 7);
  return map;
}

cv::Mat Decoded(const std::string& file) {
  const std::vector<uint8_t> bytes(file.begin(), file.end());
  return cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
}

void ExpectSame(const cv::Mat& image, const Map& map) {
  ASSERT_EQ(image.cols, map.width);
  ASSERT_EQ(image.rows, map.height);
  ASSERT_EQ(image.type(), CV_MAKETYPE(CV_32F, map.channels));
  for (int row = 0; row < map.height; ++row) {
    for (int col = 0; col < map.width; ++col) {
      for (int channel = 0; channel < map.channels; ++channel) {
        // OpenCV has blue first.
        const float value = image.ptr<float>(
            row)[col * map.channels + map.channels - 1 - channel];
        EXPECT_EQ(value,
                  map.data[(channel * map.height + row) * map.width + col]);
      }
    }
  }
}

TEST(ExchangeFiles, OpenCvReadsExr) {
  setenv("OPENCV_IO_ENABLE_OPENEXR", "1", 1);
  for (const int channels : {1, 3}) {
    const Map map = SomeMap(channels);
    cv::Mat image;
    try {
      image = Decoded(EncodeExr(map));
    } catch (const cv::Exception& error) {
      GTEST_SKIP() << "this OpenCV does not read EXR: " << error.what();
    }
    ASSERT_FALSE(image.empty());
    ExpectSame(image, map);
  }
}

TEST(ExchangeFiles, OpenCvReadsPfm) {
  for (const int channels : {1, 3}) {
    const Map map = SomeMap(channels);
    const cv::Mat image = Decoded(EncodePfm(map));
    if (image.empty()) GTEST_SKIP() << "this OpenCV does not read PFM";
    ExpectSame(image, map);
  }
}

TEST(ExchangeFiles, NpyHasNumpysHeaderAndTheValuesOfEachPixelTogether) {
  const std::string file = EncodeNpy(SomeMap(3));
  EXPECT_THAT(file, StartsWith(std::string("\x93NUMPY\x01\x00", 8)));
  EXPECT_THAT(file,
              HasSubstr("{'descr': '<f4', 'fortran_order': False, 'shape': "
                        "(5, 7, 3), }"));
  const size_t begin = file.find('\n') + 1;
  EXPECT_EQ(begin % 64, 0u);
  ASSERT_EQ(file.size() - begin, sizeof(float) * 105);
  std::vector<float> values(105);
  std::memcpy(values.data(), file.data() + begin, sizeof(float) * 105);
  const Map map = SomeMap(3);
  for (int i = 0; i < 35; ++i) {
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_EQ(values[3 * i + channel], map.data[35 * channel + i]);
  }
  EXPECT_THAT(EncodeNpy(SomeMap(1)), HasSubstr("'shape': (5, 7), }"));
}

TEST(ExchangeFiles, PlyTellsHowManyPointsFollow) {
  const std::vector<CloudPoint> points(
      3, {{1e6 + 0.125, 2, 3}, {0, 0, -1}, {1, 2, 255}});
  const std::string file = EncodePly(points);
  EXPECT_THAT(file, StartsWith("ply\nformat binary_little_endian 1.0\n"));
  EXPECT_THAT(file, HasSubstr("element vertex 3\n"));
  const std::string end = "end_header\n";
  const size_t begin = file.find(end) + end.size();
  ASSERT_EQ(file.size() - begin, 3u * (24 + 12 + 3));
  double x;
  std::memcpy(&x, file.data() + begin, sizeof(x));
  EXPECT_EQ(x, 1e6 + 0.125);
  EXPECT_EQ(static_cast<uint8_t>(file.back()), 255);
}

}  // namespace
}  // namespace hpm
