#include "src/image/load_image.h"

#include "src/base/error.h"
#include "tests/base/scratch_folder.h"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <new>
#include <random>
#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hpm {
namespace {

class LoadImage : public testing::Test {
 protected:
  std::filesystem::path Write(const std::string& name, const cv::Mat& image) {
    cv::imwrite((folder_ / name).string(), image);
    return folder_ / name;
  }

  void ExpectBadInput(const std::filesystem::path& path) {
    try {
      LoadGrayImage(path, 8, 8);
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      EXPECT_THAT(error.what(), testing::HasSubstr(path.string()));
      EXPECT_THAT(error.what(), testing::Not(testing::HasSubstr("\n")));
    }
  }

  const ScratchFolder folder_;
};

cv::Mat RandomColours(int width, int height) {
  std::mt19937 random(1);
  cv::Mat image(height, width, CV_8UC3);
  for (int i = 0; i < width * height * 3; ++i) {
    image.data[i] = static_cast<uint8_t>(random());
  }
  return image;
}

// Of the machine, not of the file: the run ends instead of going on without it.
TEST_F(LoadImage, LackOfMemoryIsNoDamage) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "sanitizers need address space of their own";
#endif
  const auto path = Write("a.png", cv::Mat(4000, 5000, CV_8UC3, cv::Scalar()));
  const pid_t child = fork();
  if (child == 0) {
    rlim_t used = 0;  // pages
    std::ifstream("/proc/self/statm") >> used;
    const rlim_t limit =
        used * static_cast<rlim_t>(sysconf(_SC_PAGESIZE)) + (24 << 20);
    const rlimit limits = {limit, limit};
    setrlimit(RLIMIT_AS, &limits);
    void* volatile large = std::malloc(64 << 20);
    if (large != nullptr) _exit(77);
    try {
      LoadGrayImage(path, 80, 60);
      _exit(1);
    } catch (const std::bad_alloc&) {
      _exit(42);
    } catch (...) {
      _exit(2);
    }
  }
  ASSERT_GT(child, 0);
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  if (WEXITSTATUS(status) == 77)
    GTEST_SKIP() << "memory cannot be limited here, as under an emulator";
  EXPECT_EQ(WEXITSTATUS(status), 42);
}

TEST_F(LoadImage, GreyIsTheRoundedBt709Luma) {
  const cv::Mat image = RandomColours(97, 61);
  const GrayImage gray = LoadGrayImage(Write("a.png", image), 97, 61);
  ASSERT_EQ(gray.data.size(), 97u * 61u);
  for (int row = 0; row < 61; ++row) {
    for (int col = 0; col < 97; ++col) {
      const auto& bgr = image.at<cv::Vec3b>(row, col);
      // In ten-thousandths, so that halves are exact.
      const int luma = 2126 * bgr[2] + 7152 * bgr[1] + 722 * bgr[0];
      EXPECT_EQ(gray.at(col, row), (luma + 5000) / 10000);
    }
  }
}

TEST_F(LoadImage, BlackAndWhiteStayExact) {
  cv::Mat image(1, 2, CV_8UC3, cv::Scalar::all(0));
  image.at<cv::Vec3b>(0, 1) = {255, 255, 255};
  const GrayImage gray = LoadGrayImage(Write("bw.png", image), 2, 1);
  EXPECT_EQ(gray.at(0, 0), 0);
  EXPECT_EQ(gray.at(1, 0), 255);
}

TEST_F(LoadImage, GreyFilesKeepTheirValues) {
  cv::Mat image(3, 5, CV_8U);
  for (int i = 0; i < 15; ++i) image.data[i] = static_cast<uint8_t>(17 * i);
  const GrayImage gray = LoadGrayImage(Write("grey.png", image), 5, 3);
  for (int i = 0; i < 15; ++i) EXPECT_EQ(gray.data[i], 17 * i);
}

TEST_F(LoadImage, AlphaIsDropped) {
  cv::Mat image(4, 4, CV_8UC4, cv::Scalar(100, 100, 100, 0));
  EXPECT_EQ(LoadGrayImage(Write("alpha.png", image), 4, 4).at(2, 2), 100);
}

TEST_F(LoadImage, SixteenBitsAreReducedToEight) {
  cv::Mat image(4, 4, CV_16UC3, cv::Scalar::all(200 * 257));
  EXPECT_EQ(LoadGrayImage(Write("deep.png", image), 4, 4).at(1, 3), 200);
}

TEST_F(LoadImage, ARangeIsStretchedToAllGreyLevels) {
  cv::Mat image(1, 6, CV_16UC1);
  const uint16_t values[] = {0, 6900, 7000, 7508, 8016, 9000};
  std::copy(std::begin(values), std::end(values), image.ptr<uint16_t>());
  ImageDecoding decoding;
  decoding.stretch = GreyRange{7000, 8016};
  const GrayImage gray =
      LoadGrayImage(Write("thermal.tif", image), 6, 1, decoding);
  EXPECT_THAT(gray.data, testing::ElementsAre(0, 1, 1, 128, 255, 255));
}

TEST_F(LoadImage, FloatingPointHasTheSameWeightsAndItsHolesAreBlack) {
  cv::Mat image(1, 3, CV_32FC3);
  image.at<cv::Vec3f>(0, 0) = {1, 0, 0};
  image.at<cv::Vec3f>(0, 1) = {0, 0, 1};
  image.at<cv::Vec3f>(0, 2) = cv::Vec3f::all(std::nanf(""));
  ImageDecoding decoding;
  decoding.stretch = GreyRange{-1, 1};
  const GrayImage gray =
      LoadGrayImage(Write("float.tif", image), 3, 1, decoding);
  EXPECT_THAT(
      gray.data,
      testing::ElementsAre(
          std::lround(1 + 127 * 1.0722), std::lround(1 + 127 * 1.2126), 0));
}

TEST_F(LoadImage, MeasuringLeavesOutWhatHasNoValueAndAThousandth) {
  cv::Mat image(100, 100, CV_16UC1);
  for (int i = 0; i < 10000; ++i)
    image.ptr<uint16_t>()[i] =
        i < 3000 ? 0 : static_cast<uint16_t>(7000 + i % 1000);
  image.ptr<uint16_t>()[5000] = 65535;
  image.ptr<uint16_t>()[6000] = 1;
  const auto range = MeasureGreyRange(Write("thermal.png", image));
  ASSERT_TRUE(range);
  EXPECT_NEAR(range->low, 7000, 3);
  EXPECT_NEAR(range->high, 7999, 3);
  EXPECT_FALSE(MeasureGreyRange(folder_ / "absent.png"));
  EXPECT_FALSE(
      MeasureGreyRange(Write("black.png", cv::Mat::zeros(9, 9, CV_16UC1))));
}

// A smooth picture, so that what is left is where its parts lie.
TEST_F(LoadImage, ReducedDecodingKeepsEverythingInPlace) {
  for (const auto& [width, height] :
       {std::pair(805, 603), std::pair(801, 600), std::pair(808, 607)}) {
    cv::Mat image(height, width, CV_8UC3);
    for (int row = 0; row < height; ++row) {
      for (int col = 0; col < width; ++col) {
        const double wave = 127 + 60 * std::sin(0.05 * col + 0.02 * row) +
                            60 * std::cos(0.04 * row - 0.01 * col);
        image.at<cv::Vec3b>(row, col) =
            cv::Vec3b::all(static_cast<uint8_t>(wave));
      }
    }
    const auto path = folder_ / "wave.jpg";
    cv::imwrite(path.string(), image, {cv::IMWRITE_JPEG_QUALITY, 98});
    for (const int small_width : {400, 200, 97, 50, 25}) {
      const int small_height = small_width * 3 / 4;
      const GrayImage full = LoadGrayImage(path, small_width, small_height);
      ImageDecoding decoding;
      decoding.reduction =
          ReductionFor(width, height, small_width, small_height);
      EXPECT_GT(decoding.reduction, 1);
      decoding.file_width = width;
      decoding.file_height = height;
      const GrayImage reduced =
          LoadGrayImage(path, small_width, small_height, decoding);
      ASSERT_EQ(reduced.data.size(), full.data.size());
      double sum = 0;
      for (size_t i = 0; i < full.data.size(); ++i) {
        EXPECT_NEAR(reduced.data[i], full.data[i], 3);
        sum += std::abs(reduced.data[i] - full.data[i]);
      }
      EXPECT_LT(sum / static_cast<double>(full.data.size()), 0.5);
    }
  }
}

TEST_F(LoadImage, TheReductionLeavesEnoughPixels) {
  EXPECT_EQ(ReductionFor(800, 600, 800, 600), 1);
  EXPECT_EQ(ReductionFor(799, 600, 400, 300), 1);
  EXPECT_EQ(ReductionFor(800, 600, 400, 300), 2);
  EXPECT_EQ(ReductionFor(800, 600, 400, 301), 1);
  EXPECT_EQ(ReductionFor(800, 600, 51, 37), 2);
  EXPECT_EQ(ReductionFor(800, 600, 50, 37), 4);
  EXPECT_EQ(ReductionFor(8000, 6000, 400, 300), 4);
  EXPECT_EQ(ReductionFor(8000, 6000, 200, 150), 8);
}

TEST_F(LoadImage, ShrinkingAveragesAreas) {
  cv::Mat image(4, 6, CV_8U);
  for (int i = 0; i < 24; ++i) image.data[i] = static_cast<uint8_t>(10 * i);
  const GrayImage gray = LoadGrayImage(Write("large.png", image), 3, 2);
  ASSERT_EQ(gray.width, 3);
  ASSERT_EQ(gray.height, 2);
  for (int row = 0; row < 2; ++row) {
    for (int col = 0; col < 3; ++col) {
      const int at = 2 * row * 6 + 2 * col;
      const double mean = 10 * (at + at + 1 + at + 6 + at + 7) / 4.0;
      EXPECT_NEAR(gray.at(col, row), mean, 0.5);
    }
  }
}

TEST_F(LoadImage, MissingFileIsBadInput) {
  ExpectBadInput(folder_ / "absent.png");
}

TEST_F(LoadImage, AKindThatCannotBeDecodedIsSaidToBeConverted) {
  WriteFile(folder_ / "a.xyz", "GIF89z not of any kind");
  try {
    LoadGrayImage(folder_ / "a.xyz", 8, 8);
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("convert"));
  }
}

TEST_F(LoadImage, FolderIsBadInput) { ExpectBadInput(folder_.path()); }

TEST_F(LoadImage, GarbageAndEmptyFilesAreBadInput) {
  WriteFile(folder_ / "garbage.jpg", "\xff\xd8\xff this is not a picture");
  ExpectBadInput(folder_ / "garbage.jpg");
  WriteFile(folder_ / "empty.png", "");
  ExpectBadInput(folder_ / "empty.png");
}

std::string ReadAll(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void WriteAll(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

TEST_F(LoadImage, FileCutAnywhereIsBadInput) {
  for (const char* name :
       {"a.jpg", "a.png", "a.bmp", "a.tif", "a.webp", "a.ppm", "a.jp2"}) {
    SCOPED_TRACE(name);
    const auto path = Write(name, RandomColours(97, 61));
    const std::string whole = ReadAll(path);
    EXPECT_EQ(LoadGrayImage(path, 97, 61).width, 97);
    for (const double share : {0.5, 0.9, 0.99}) {
      SCOPED_TRACE(share);
      WriteAll(path,
               whole.substr(0,
                            static_cast<size_t>(
                                share * static_cast<double>(whole.size()))));
      ExpectBadInput(path);
    }
  }
}

TEST_F(LoadImage, ProgressiveJpegCutBetweenItsScansIsBadInput) {
  const auto path = folder_ / "a.jpg";
  cv::imwrite(
      path.string(), RandomColours(97, 61), {cv::IMWRITE_JPEG_PROGRESSIVE, 1});
  const std::string whole = ReadAll(path);
  EXPECT_EQ(LoadGrayImage(path, 97, 61).width, 97);
  WriteAll(path, whole.substr(0, whole.size() - 2));
  ExpectBadInput(path);
}

TEST_F(LoadImage, WhatFollowsTheEndOfAJpegAndThumbnailsInItDoNotMatter) {
  const auto path = Write("a.jpg", RandomColours(97, 61));
  const std::string whole = ReadAll(path);
  // A picture of its own in a segment of the application.
  const std::string thumbnail =
      ReadAll(Write("small.jpg", RandomColours(8, 8)));
  const size_t length = thumbnail.size() + 2;
  const std::string segment = std::string("\xff\xe1") +
                              static_cast<char>(length >> 8) +
                              static_cast<char>(length & 0xff) + thumbnail;
  const std::string with_thumbnail =
      whole.substr(0, 2) + segment + whole.substr(2);
  WriteAll(path,
           with_thumbnail + "appended by a camera" + std::string(100, '\0'));
  EXPECT_EQ(LoadGrayImage(path, 97, 61).width, 97);
  WriteAll(path, with_thumbnail.substr(0, with_thumbnail.size() / 2));
  ExpectBadInput(path);
}

TEST_F(LoadImage, FileCutInItsHeaderIsBadInput) {
  const auto path = Write("cut.png", RandomColours(8, 8));
  std::filesystem::resize_file(path, 20);
  ExpectBadInput(path);
}

}  // namespace
}  // namespace hpm
