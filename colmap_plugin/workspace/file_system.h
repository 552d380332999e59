// The clock of the file system that a lock lies on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace hpm {

// The present time in nanoseconds since 1970, by the clock that stamps the
// files of this folder: that of the server on network file systems. Nothing if
// no file can be written there.
std::optional<int64_t> FileSystemTime(const std::filesystem::path& folder);

}  // namespace hpm
