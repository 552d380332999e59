#include "colmap_plugin/formats/consistency_graph.h"

#include "colmap_plugin/formats/content_hash.h"
#include "tests/colmap_plugin/formats/test_files.h"

namespace hpm {
namespace {

std::string GraphBytes(std::string_view header,
                       const std::vector<int32_t>& data) {
  Bytes bytes;
  bytes.Text(header);
  for (const int32_t value : data) bytes.Add(value);
  return bytes.str();
}

TEST(ConsistencyGraph, WritesGroupsByteForByteAndReadsThemBack) {
  const ScratchFolder folder;
  const ConsistencyGraph graph{4, 3, {2, 0, 2, 7, 9, 3, 2, 1, 0}};
  const PublishedFile published =
      WriteConsistencyGraph(folder / "g.bin", graph);
  EXPECT_EQ(published.state, StateOf(folder / "g.bin"));
  EXPECT_EQ(published.checksum, HashFile(folder / "g.bin", CancelToken()));
  EXPECT_EQ(ReadFile(folder / "g.bin"), GraphBytes("4&3&1&", graph.data));
  EXPECT_EQ(ReadConsistencyGraph(folder / "g.bin").data, graph.data);
}

TEST(ConsistencyGraph, WithoutConsistentPixelsTheFileIsTheBareHeader) {
  const ScratchFolder folder;
  WriteConsistencyGraph(folder / "g.bin", {4, 3, {}});
  EXPECT_EQ(ReadFile(folder / "g.bin"), "4&3&1&");
  EXPECT_TRUE(ReadConsistencyGraph(folder / "g.bin").data.empty());
}

TEST(ConsistencyGraph, EveryPrefixThatCutsAGroupIsRefused) {
  const ScratchFolder folder;
  const std::string bytes = GraphBytes("4&3&1&", {2, 0, 2, 7, 9});
  for (size_t length = 0; length < bytes.size(); ++length) {
    if (length == 6) continue;  // the bare header is a valid graph
    SCOPED_TRACE(length);
    WriteFile(folder / "g.bin", bytes.substr(0, length));
    ExpectError(ErrorCode::kBadInput, "g.bin", [&] {
      ReadConsistencyGraph(folder / "g.bin");
    });
  }
}

TEST(ConsistencyGraph, HostileGroupsAreRefusedByReaderAndWriter) {
  const ScratchFolder folder;
  for (const std::vector<int32_t>& data : {std::vector<int32_t>{4, 0, 1, 0},
                                           {0, 3, 1, 0},
                                           {-1, 0, 1, 0},
                                           {0, 0, 0},
                                           {0, 0, -5, 1},
                                           {0, 0, 2147483647, 1},
                                           {0, 0, 1, -1}}) {
    WriteFile(folder / "g.bin", GraphBytes("4&3&1&", data));
    ExpectError(ErrorCode::kBadInput, "g.bin", [&] {
      ReadConsistencyGraph(folder / "g.bin");
    });
    ExpectError(ErrorCode::kFailure, "h.bin", [&] {
      WriteConsistencyGraph(folder / "h.bin", {4, 3, data});
    });
  }
  WriteFile(folder / "g.bin", "4&3&3&");
  ExpectError(ErrorCode::kBadInput, "g.bin", [&] {
    ReadConsistencyGraph(folder / "g.bin");
  });
  EXPECT_EQ(folder.CountFiles(), 1u);
}

}  // namespace
}  // namespace hpm
