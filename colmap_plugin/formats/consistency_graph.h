// COLMAP's consistency graph: "<W>&<H>&1&" then int32 groups
// "col, row, n, idx_1 ... idx_n" for pixels with at least one consistent
// source. idx is the image index of SparseModel, not the image id.
#pragma once

#include "colmap_plugin/formats/published_file.h"

#include <cstdint>
#include <filesystem>
#include <vector>

namespace hpm {

struct ConsistencyGraph {
  int width = 0;
  int height = 0;
  std::vector<int32_t> data;  // the groups, rows then columns, as in the file
};

// Throws Error(kBadInput) for a damaged file: a group that is cut off, lies
// outside the image, is empty or has a negative index.
ConsistencyGraph ReadConsistencyGraph(const std::filesystem::path& path);

// Atomic. Throws Error(kFailure) for groups that the reader would refuse. The
// checksum is HashFile()'s.
PublishedFile WriteConsistencyGraph(const std::filesystem::path& path,
                                    const ConsistencyGraph& graph);

}  // namespace hpm
