#include "colmap_plugin/formats/consistency_graph.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/content_hash.h"
#include "colmap_plugin/formats/grid_header.h"
#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/base/retries.h"

#include <fmt/format.h>

namespace hpm {
namespace {

bool IsWellFormed(const ConsistencyGraph& graph) {
  if (graph.width <= 0 || graph.height <= 0) return false;
  const std::vector<int32_t>& data = graph.data;
  size_t i = 0;
  while (i < data.size()) {
    if (data.size() - i < 3) return false;
    const int32_t col = data[i];
    const int32_t row = data[i + 1];
    const int32_t num_sources = data[i + 2];
    if (col < 0 || col >= graph.width || row < 0 || row >= graph.height)
      return false;
    i += 3;
    if (num_sources <= 0 || static_cast<size_t>(num_sources) > data.size() - i)
      return false;
    for (const size_t end = i + static_cast<size_t>(num_sources); i < end;
         ++i) {
      if (data[i] < 0) return false;
    }
  }
  return true;
}

}  // namespace

ConsistencyGraph ReadConsistencyGraph(const std::filesystem::path& path) {
  const InputFile file(path);
  const GridHeader header = ReadGridHeader(file);
  const uint64_t num_bytes = file.size() - header.num_bytes;
  ConsistencyGraph graph{header.width, header.height, {}};
  bool good = header.channels == 1 && num_bytes % sizeof(int32_t) == 0;
  if (good) {
    graph.data.resize(num_bytes / sizeof(int32_t));
    good = file.ReadAt(header.num_bytes, graph.data.data(), num_bytes) ==
               num_bytes &&
           IsWellFormed(graph);
  }
  if (!good) {
    throw Error(
        ErrorCode::kBadInput,
        fmt::format(
            "{} is not a complete consistency graph; delete it and run again",
            path.string()));
  }
  return graph;
}

PublishedFile WriteConsistencyGraph(const std::filesystem::path& path,
                                    const ConsistencyGraph& graph) {
  if (!IsWellFormed(graph)) {
    throw Error(ErrorCode::kFailure,
                fmt::format("refused to write {}: its groups contradict its "
                            "size; please report "
                            "this",
                            path.string()));
  }
  const std::string header = FormatGridHeader(graph.width, graph.height, 1);
  const size_t data_bytes = graph.data.size() * sizeof(int32_t);
  ContentHash hash;
  hash.Add(header.data(), header.size()).Add(graph.data.data(), data_bytes);
  const FileState state = RetryWriting([&] {
    AtomicFile file(path);
    file.Write(header);
    file.Write(graph.data.data(), data_bytes);
    return file.Commit();
  });
  return {state, hash.Hex()};
}

}  // namespace hpm
