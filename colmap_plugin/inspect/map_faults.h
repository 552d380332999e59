// What is wrong with the contents of a map file, whoever wrote it.
#pragma once

#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/depth_range.h"

#include <filesystem>
#include <limits>
#include <string>

namespace hpm {

// In one line, without the file's name; empty if nothing is. Memory for some
// rows only. A file that cannot be read has no fault: UnreadableFile is thrown.

constexpr DepthRange kAnyDepth = {0, std::numeric_limits<float>::infinity()};

// Header, length, one channel, all values finite, not negative, and zero or in
// `range`.
std::string FaultOfDepths(const std::filesystem::path& path,
                          const DepthRange& range);

// Header, length, three channels, all values finite, every normal zero or of
// length one.
std::string FaultOfNormals(const std::filesystem::path& path);

// Header, length, one channel, every value in 0..1.
std::string FaultOfConfidence(const std::filesystem::path& path);

// Header, whole groups inside the image, every index below num_images.
std::string FaultOfGraph(const std::filesystem::path& path, int num_images);

}  // namespace hpm
