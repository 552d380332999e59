#include "colmap_plugin/inspect/map_faults.h"

#include "src/base/input_file.h"
#include "tests/base/scratch_folder.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::HasSubstr;

class MapFaults : public testing::Test {
 protected:
  // As other programs write maps: values that ours refuses among them.
  std::filesystem::path Write(int channels, const std::vector<float>& values) {
    const auto path = folder_ / "map.bin";
    std::string bytes = "2&1&" + std::to_string(channels) + "&";
    bytes.append(reinterpret_cast<const char*>(values.data()),
                 values.size() * sizeof(float));
    WriteFile(path, bytes);
    return path;
  }
  ScratchFolder folder_;
};

TEST_F(MapFaults, OfDepths) {
  const DepthRange range = {1, 5};
  EXPECT_EQ(FaultOfDepths(Write(1, {0, 5}), range), "");
  EXPECT_EQ(FaultOfDepths(Write(1, {0, 6}), range),
            "the depth 6 is not in 1 ... 5 at column 1, row 0");
  EXPECT_THAT(FaultOfDepths(Write(1, {-1, 0}), range), HasSubstr("negative"));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(FaultOfDepths(Write(1, {nan, 0}), range), HasSubstr("finite"));
  EXPECT_THAT(FaultOfDepths(Write(1, {1}), range), HasSubstr("bytes"));
  EXPECT_THAT(FaultOfDepths(Write(2, {1, 1, 1, 1}), range),
              HasSubstr("2 channels in place of 1"));
}

TEST_F(MapFaults, OfNormals) {
  EXPECT_EQ(FaultOfNormals(Write(3, {0, 0, 0, 0.6f, 0, 0.8f})), "");
  EXPECT_THAT(FaultOfNormals(Write(3, {0, 0, 0, 0.6f, 0, 1})),
              HasSubstr("length"));
}

TEST_F(MapFaults, WhatCannotBeReadHasNone) {
  const auto path = folder_ / "map.bin";
  EXPECT_THROW(FaultOfDepths(path, {}), UnreadableFile);
  std::filesystem::create_directory(path);
  EXPECT_THROW(FaultOfDepths(path, {}), UnreadableFile);
  EXPECT_THROW(FaultOfNormals(path), UnreadableFile);
  EXPECT_THROW(FaultOfGraph(path, 9), UnreadableFile);
}

}  // namespace
}  // namespace hpm
