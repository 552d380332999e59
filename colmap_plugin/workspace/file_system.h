// What matters of the file system that a workspace lies on.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace hpm {

// The present time in nanoseconds since 1970, by the clock that stamps the
// files of this folder: that of the server on network file systems. Nothing if
// no file can be written there.
std::optional<int64_t> FileSystemTime(const std::filesystem::path& folder);

// Since when files of this folder that are not synced may be lost without
// notice: the running kernel (BootId()). Empty where that says nothing, for
// another machine holds the bytes.
std::string UnsyncedSince(const std::filesystem::path& folder);

}  // namespace hpm
