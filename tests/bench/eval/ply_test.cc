#include "bench/eval/ply.h"

#include "src/base/error.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

namespace hpm {
namespace {

class Ply : public testing::Test {
 protected:
  std::filesystem::path path_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string(
           testing::UnitTest::GetInstance()->current_test_info()->name()) +
       ".ply");

  void WriteFile(const std::string& text) {
    std::ofstream(path_, std::ios::binary) << text;
  }
  std::string ReadFile() {
    std::ifstream stream(path_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }
  void ExpectBadInput() {
    try {
      ReadPly(path_);
      FAIL() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      EXPECT_NE(std::string(error.what()).find(path_.string()),
                std::string::npos);
    }
  }
};

TEST_F(Ply, KeepsPointsNormalsAndColors) {
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {-4, 5.5f, 6}};
  cloud.normals = {{0, 0, -1}, {1, 0, 0}};
  cloud.colors = {{255, 0, 7}, {1, 2, 3}};
  WritePly(path_, cloud);
  const PointCloud read = ReadPly(path_);
  ASSERT_EQ(read.points.size(), 2u);
  EXPECT_EQ(read.points[1].y, 5.5f);
  EXPECT_EQ(read.normals[0].z, -1);
  EXPECT_EQ(read.colors[0][0], 255);
  EXPECT_EQ(read.colors[1][2], 3);
}

TEST_F(Ply, PassesOverUnknownPropertiesAndLaterElements) {
  const double x = 1.5, y = 2.5, z = 3.5;
  std::string text =
      "ply\nformat binary_little_endian 1.0\ncomment made by hand\nelement "
      "vertex 1\n"
      "property uchar quality\nproperty double x\nproperty double y\nproperty "
      "double z\n"
      "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
  text += '\x09';
  for (const double* value : {&x, &y, &z}) {
    text.append(reinterpret_cast<const char*>(value), sizeof(double));
  }
  WriteFile(text);
  const PointCloud cloud = ReadPly(path_);
  ASSERT_EQ(cloud.points.size(), 1u);
  EXPECT_EQ(cloud.points[0].z, 3.5f);
  EXPECT_TRUE(cloud.normals.empty());
  EXPECT_TRUE(cloud.colors.empty());
}

TEST_F(Ply, EveryTruncationIsAnErrorThatNamesTheFile) {
  PointCloud cloud;
  cloud.points = {{1, 2, 3}, {4, 5, 6}};
  WritePly(path_, cloud);
  const std::string whole = ReadFile();
  for (size_t length = 0; length < whole.size(); ++length) {
    WriteFile(whole.substr(0, length));
    ExpectBadInput();
  }
}

TEST_F(Ply, AHugeVertexCountIsAnErrorBeforeAnyAllocation) {
  WriteFile(
      "ply\nformat binary_little_endian 1.0\nelement vertex "
      "18446744073709551615\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n");
  ExpectBadInput();
}

TEST_F(Ply, AsciiIsRefused) {
  WriteFile(
      "ply\nformat ascii 1.0\nelement vertex 0\nproperty float "
      "x\nend_header\n");
  ExpectBadInput();
}

}  // namespace
}  // namespace hpm
