#include "colmap_plugin/workspace/image_size.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sys/stat.h>

namespace hpm {
namespace {

std::string Encoded(const std::string& extension,
                    int width,
                    int height,
                    int type = CV_8UC3) {
  std::vector<unsigned char> bytes;
  cv::imencode(
      extension, cv::Mat(height, width, type, cv::Scalar::all(50)), bytes);
  return {bytes.begin(), bytes.end()};
}

class ImageSizeTest : public ::testing::Test {
 protected:
  // "37x21", or "none". The name says nothing about the type on purpose.
  std::string SizeOfFile() const {
    const auto size = ReadImageSize(folder_.path() / "image");
    return size ? fmt::format("{}x{}", size->width, size->height) : "none";
  }
  std::string SizeOf(const std::string& bytes) {
    WriteFile(folder_.path() / "image", bytes);
    return SizeOfFile();
  }
  ScratchFolder folder_;
};

TEST_F(ImageSizeTest, IsReadFromEveryUsualType) {
  for (const char* extension : {".jpg", ".png", ".bmp", ".tif", ".ppm"}) {
    EXPECT_EQ(SizeOf(Encoded(extension, 37, 21)), "37x21") << extension;
    EXPECT_EQ(SizeOf(Encoded(extension, 1, 300)), "1x300") << extension;
  }
  EXPECT_EQ(SizeOf(Encoded(".png", 37, 21, CV_16UC1)), "37x21");
  EXPECT_EQ(SizeOf(Encoded(".tif", 37, 21, CV_16UC3)), "37x21");
}

TEST_F(ImageSizeTest, DepthIsReadFromEveryUsualType) {
  const auto depth_of = [&](const char* extension, int type) {
    WriteFile(folder_.path() / "image", Encoded(extension, 37, 21, type));
    const auto size = ReadImageSize(folder_.path() / "image");
    EXPECT_TRUE(size) << extension;
    EXPECT_EQ(size && size->is_jpeg, std::string(extension) == ".jpg");
    return size ? size->depth : SampleDepth::k8;
  };
  for (const char* extension : {".jpg", ".png", ".bmp", ".tif", ".ppm"}) {
    EXPECT_EQ(depth_of(extension, CV_8UC3), SampleDepth::k8) << extension;
  }
  EXPECT_EQ(depth_of(".jpg", CV_8UC1), SampleDepth::k8);
  EXPECT_EQ(depth_of(".tif", CV_8UC1), SampleDepth::k8);
  for (const char* extension : {".png", ".tif", ".ppm"})
    EXPECT_EQ(depth_of(extension, CV_16UC3), SampleDepth::k16) << extension;
  EXPECT_EQ(depth_of(".png", CV_16UC1), SampleDepth::k16);
  EXPECT_EQ(depth_of(".tif", CV_16UC1), SampleDepth::k16);
  EXPECT_EQ(depth_of(".tif", CV_32FC1), SampleDepth::kOther);
  EXPECT_EQ(depth_of(".tif", CV_32FC3), SampleDepth::kOther);
  EXPECT_EQ(depth_of(".hdr", CV_32FC3), SampleDepth::kOther);
}

TEST_F(ImageSizeTest, JpegMetadataAndFillBytesAreSkipped) {
  const std::string jpeg = Encoded(".jpg", 37, 21);
  std::string app1 =
      std::string("\xff\xe1\xff\xff", 4) + std::string(0xfffd, '\xff');
  EXPECT_EQ(
      SizeOf(jpeg.substr(0, 2) + app1 + app1 + "\xff\xff\xff" + jpeg.substr(2)),
      "37x21");
}

TEST_F(ImageSizeTest, TiffOfBothByteOrdersIsRead) {
  const std::string little(
      "II*\0\x08\0\0\0\x02\0"
      "\x00\x01\x03\0\x01\0\0\0\x25\0\0\0"
      "\x01\x01\x04\0\x01\0\0\0\x15\0\0\0",
      34);
  const std::string big(
      "MM\0*\0\0\0\x08\0\x02"
      "\x01\x00\0\x03\0\0\0\x01\0\x25\0\0"
      "\x01\x01\0\x04\0\0\0\x01\0\0\0\x15",
      34);
  EXPECT_EQ(SizeOf(little), "37x21");
  EXPECT_EQ(SizeOf(big), "37x21");
}

TEST_F(ImageSizeTest, BottomUpAndTopDownBitmapsHaveTheSameSize) {
  std::string bmp = Encoded(".bmp", 37, 21);
  const int32_t negative = -21;
  bmp.replace(22, 4, reinterpret_cast<const char*>(&negative), 4);
  EXPECT_EQ(SizeOf(bmp), "37x21");
}

TEST_F(ImageSizeTest, APrefixGivesTheSizeOrNothing) {
  for (const char* extension : {".jpg", ".png", ".bmp", ".tif"}) {
    const std::string start = Encoded(extension, 37, 21).substr(0, 700);
    WriteFile(folder_.path() / "image", start);
    for (size_t size = start.size(); size-- > 0;) {
      std::filesystem::resize_file(folder_.path() / "image", size);
      EXPECT_THAT(SizeOfFile(), testing::AnyOf("37x21", "none"))
          << extension << " " << size;
    }
    EXPECT_EQ(SizeOfFile(), "none");
  }
}

TEST_F(ImageSizeTest, BombsAndImpossibleSizesGiveNothing) {
  EXPECT_EQ(SizeOf(PngHeader(32768, 32768)), "32768x32768");
  EXPECT_EQ(SizeOf(PngHeader(65500, 65500)), "none");
  EXPECT_EQ(SizeOf(PngHeader(0xffffffffu, 0xffffffffu)), "none");
  EXPECT_EQ(SizeOf(PngHeader(0, 10)), "none");
  EXPECT_EQ(SizeOf("P5\n65500 65500\n255\n"), "none");
  EXPECT_EQ(
      SizeOf(std::string(
          "BM\0\0\0\0\0\0\0\0\0\0\0\0\x28\0\0\0\x10\0\0\0\0\0\0\x80", 26)),
      "none");
}

TEST_F(ImageSizeTest, HostileJpegSegmentsEnd) {
  std::string segments = "\xff\xd8";
  for (int i = 0; i < 200000; ++i) segments += std::string("\xff\xe0\0\x02", 4);
  EXPECT_EQ(SizeOf(segments), "none");
  EXPECT_EQ(SizeOf("\xff\xd8" + std::string(1000000, '\xff')), "none");
  EXPECT_EQ(SizeOf(std::string("\xff\xd8\xff\xe0\0\x01", 6)), "none");
}

TEST_F(ImageSizeTest, MissingFilesFoldersAndPipesGiveNothing) {
  EXPECT_EQ(ReadImageSize(folder_.path() / "absent.jpg"), std::nullopt);
  EXPECT_EQ(ReadImageSize(folder_.path()), std::nullopt);
  ASSERT_EQ(mkfifo((folder_.path() / "pipe.jpg").c_str(), 0600), 0);
  EXPECT_EQ(ReadImageSize(folder_.path() / "pipe.jpg"), std::nullopt);
  EXPECT_EQ(SizeOf("no image"), "none");
}

}  // namespace
}  // namespace hpm
