// COLMAP's consistency graph: "<W>&<H>&1&" then int32 groups
// "col, row, n, idx_1 ... idx_n" for pixels with at least one consistent source.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace hpm {

struct ConsistencyGraph {
  int width = 0;
  int height = 0;
  std::vector<int32_t> data;  // the groups, rows then columns, as in the file
};

ConsistencyGraph ReadConsistencyGraph(const std::filesystem::path& path);
void WriteConsistencyGraph(const std::filesystem::path& path, const ConsistencyGraph& graph);

}  // namespace hpm
