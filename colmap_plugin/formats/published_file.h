// What is known of a file that was published: enough to tell later whether it
// is still the same.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

namespace hpm {

struct FileState {
  uint64_t num_bytes = 0;
  int64_t time_ns = 0;  // of the last change, since 1970

  bool operator==(const FileState& other) const {
    return num_bytes == other.num_bytes && time_ns == other.time_ns;
  }
  bool operator!=(const FileState& other) const { return !(*this == other); }
};

// Nothing if there is no such file. Throws Error(kBadInput) where the disk does
// not answer.
std::optional<FileState> StateOf(const std::filesystem::path& path);
// Of an open file.
std::optional<FileState> StateOf(int fd);

struct PublishedFile {
  FileState state;
  std::string checksum;  // of its contents, see content_hash.h
};

}  // namespace hpm
