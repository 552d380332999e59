#include "colmap_plugin/formats/map_file.h"

#include "tests/colmap_plugin/formats/test_files.h"

#include <csignal>
#include <cstring>
#include <limits>

#include <sys/resource.h>

namespace hpm {
namespace {

Map SmallNormalMap() { return {2, 1, 3, {1, 2, 3, 4, 5, 6}}; }

std::string SmallNormalMapBytes() {
  Bytes bytes;
  bytes.Text("2&1&3&");
  for (const float value : {1.f, 2.f, 3.f, 4.f, 5.f, 6.f}) bytes.Add(value);
  return bytes.str();
}

TEST(MapFile, WritesHeaderAndPlanesByteForByte) {
  const ScratchFolder folder;
  WriteMap(folder / "m.bin", SmallNormalMap());
  EXPECT_EQ(ReadFile(folder / "m.bin"), SmallNormalMapBytes());
}

TEST(MapFile, ReadsWhatItWroteAndCreatesFolders) {
  const ScratchFolder folder;
  const auto path = folder / "cam1/day 2/x.jpg.geometric.bin";
  WriteMap(path, SmallNormalMap());
  const Map map = ReadMap(path);
  EXPECT_EQ(map.width, 2);
  EXPECT_EQ(map.height, 1);
  EXPECT_EQ(map.channels, 3);
  EXPECT_EQ(map.data, SmallNormalMap().data);
  EXPECT_EQ(folder.CountFiles(), 1u);
}

TEST(MapFile, ChecksumDoesNotDependOnTheOrderOfTheRows) {
  const ScratchFolder folder;
  // Several parts of the reader.
  const int width = 7001, height = 40;
  std::vector<float> values(3 * width * height);
  for (size_t i = 0; i < values.size(); ++i)
    values[i] = static_cast<float>(i % 1000003);
  const PublishedFile map =
      WriteMap(folder / "a.bin", {width, height, 3, values});
  EXPECT_EQ(map.state, StateOf(folder / "a.bin"));
  EXPECT_EQ(MapReader(folder / "a.bin").Checksum(CancelToken()), map.checksum);

  MapWriter writer(folder / "b.bin", {width, height, 3});
  for (int row = height - 1; row >= 0; --row) {
    for (const int channel : {1, 0, 2})
      writer.WriteRows(
          channel, row, 1, &values[(channel * height + row) * width]);
  }
  EXPECT_EQ(writer.Commit().checksum, map.checksum);
  EXPECT_EQ(ReadFile(folder / "b.bin"), ReadFile(folder / "a.bin"));
}

TEST(MapFile, ChecksumChangesWithEveryBit) {
  const ScratchFolder folder;
  const auto path = folder / "m.bin";
  const std::string checksum = WriteMap(path, SmallNormalMap()).checksum;
  const std::string bytes = ReadFile(path);
  const size_t header_bytes = std::strlen("2&1&3&");
  for (size_t bit = 8 * header_bytes; bit < 8 * bytes.size(); ++bit) {
    std::string other = bytes;
    other[bit / 8] = static_cast<char>(other[bit / 8] ^ (1 << bit % 8));
    WriteFile(path, other);
    EXPECT_NE(MapReader(path).Checksum(CancelToken()), checksum) << bit;
  }
  // Another size of the same length, and rows in another order.
  for (const std::string& other :
       {"1&2&3&" + bytes.substr(header_bytes),
        "2&3&1&" + bytes.substr(header_bytes),
        bytes.substr(0, header_bytes) + bytes.substr(header_bytes + 8, 8) +
            bytes.substr(header_bytes, 8) + bytes.substr(header_bytes + 16)}) {
    WriteFile(path, other);
    EXPECT_NE(MapReader(path).Checksum(CancelToken()), checksum);
  }
}

TEST(MapFile, HeaderDoesNotDependOnTheLocale) {
  const ScratchFolder folder;
  const CommaLocale locale;
  WriteMap(folder / "m.bin", {1234, 1, 1, std::vector<float>(1234, 0.5f)});
  EXPECT_EQ(ReadFile(folder / "m.bin").substr(0, 9), "1234&1&1&");
  EXPECT_EQ(ReadMapHeader(folder / "m.bin").width, 1234);
}

TEST(MapFile, AllowsBlanksInTheHeaderButEatsNoDataByte) {
  const ScratchFolder folder;
  // 0x20 and 0x0A are data here: the reader must stop right after the third
  // '&'.
  WriteFile(folder / "m.bin", " 1 & 1 & 1 & \n  ");
  const Map map = ReadMap(folder / "m.bin");
  const std::string data = " \n  ";
  EXPECT_EQ(std::memcmp(map.data.data(), data.data(), 4), 0);
}

TEST(MapFile, EveryProperPrefixAndEveryExtraByteIsRefused) {
  const ScratchFolder folder;
  const std::string bytes = SmallNormalMapBytes();
  for (size_t length = 0; length < bytes.size(); ++length) {
    SCOPED_TRACE(length);
    WriteFile(folder / "m.bin", bytes.substr(0, length));
    ExpectError(
        ErrorCode::kBadInput, "m.bin", [&] { ReadMap(folder / "m.bin"); });
    ExpectError(ErrorCode::kBadInput, "m.bin", [&] {
      ReadMapHeader(folder / "m.bin");
    });
  }
  WriteFile(folder / "m.bin", bytes + '\0');
  ExpectError(
      ErrorCode::kBadInput, "m.bin", [&] { ReadMap(folder / "m.bin"); });
}

TEST(MapFile, HostileHeadersAreRefusedWithoutAllocation) {
  const ScratchFolder folder;
  const std::string many_digits(100000, '9');
  for (const std::string& header :
       {std::string("-2&1&3&"),
        std::string("0&1&1&"),
        std::string("2&1&"),
        std::string("2,1,3,"),
        std::string("4000000000&4000000000&1&"),
        std::string("2147483647&2147483647&2147483647&"),
        // The product is 2^64: an unchecked one would come out as 0.
        std::string("1073741824&1073741824&16&"),
        std::string("2x&1&3&"),
        std::string("nan&1&1&"),
        std::string(1000, ' ') + "2&1&3&",
        many_digits + "&1&1&",
        std::string("&&&"),
        std::string("hello"),
        std::string(5, '\0')}) {
    SCOPED_TRACE(header.substr(0, 40));
    for (const size_t num_values : {0, 6}) {
      WriteFile(folder / "m.bin",
                header + std::string(num_values * sizeof(float), '\0'));
      ExpectError(
          ErrorCode::kBadInput, "m.bin", [&] { ReadMap(folder / "m.bin"); });
    }
  }
}

TEST(MapFile, MissingFileAndFolderAreBadInput) {
  const ScratchFolder folder;
  ExpectError(
      ErrorCode::kBadInput, "none.bin", [&] { ReadMap(folder / "none.bin"); });
  ExpectError(
      ErrorCode::kBadInput, "regular file", [&] { ReadMap(folder.path()); });
}

TEST(MapFile, NonFiniteValuesAreNeverWritten) {
  const ScratchFolder folder;
  for (const float bad : {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(),
                          -std::numeric_limits<float>::infinity()}) {
    Map map{3, 2, 1, {1, 1, 1, 1, 1, 1}};
    map.data[4] = bad;
    ExpectError(ErrorCode::kFailure, "column 1, row 1", [&] {
      WriteMap(folder / "m.bin", map);
    });
  }
  EXPECT_EQ(folder.CountFiles(), 0u);
}

TEST(MapFile, ContradictorySizesAreNeverWritten) {
  const ScratchFolder folder;
  for (const Map& map : {Map{2, 2, 1, {1, 2, 3}},
                         Map{2, 2, 1, {1, 2, 3, 4, 5}},
                         Map{0, 2, 1, {}},
                         Map{1, 1, -1, {1}}}) {
    ExpectError(
        ErrorCode::kFailure, "m.bin", [&] { WriteMap(folder / "m.bin", map); });
  }
  EXPECT_EQ(folder.CountFiles(), 0u);
}

TEST(MapFile, FileSizeLimitLeavesTheOldFileAndNoTemporary) {
  const ScratchFolder folder;
  WriteMap(folder / "m.bin", SmallNormalMap());

  const auto previous_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit previous = {};
  getrlimit(RLIMIT_FSIZE, &previous);
  rlimit limit = previous;
  limit.rlim_cur = 8192;
  setrlimit(RLIMIT_FSIZE, &limit);
  ErrorCode code = ErrorCode::kFailure;
  std::string message;
  try {
    WriteMap(folder / "m.bin", {64, 64, 1, std::vector<float>(64 * 64, 1.f)});
  } catch (const Error& error) {
    code = error.code();
    message = error.what();
  }
  setrlimit(RLIMIT_FSIZE, &previous);
  std::signal(SIGXFSZ, previous_handler);

  EXPECT_EQ(code, ErrorCode::kOutOfResources);
  EXPECT_THAT(message, testing::HasSubstr("m.bin"));
  EXPECT_THAT(message, testing::HasSubstr("8192 bytes were written"));
  EXPECT_EQ(ReadFile(folder / "m.bin"), SmallNormalMapBytes());
  EXPECT_EQ(folder.CountFiles(), 1u);
}

}  // namespace
}  // namespace hpm
