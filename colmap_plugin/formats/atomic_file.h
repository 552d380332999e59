// A file appears complete or not at all: temporary file in the same folder,
// every write checked, fsync, rename, fsync of the folder.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string_view>

namespace hpm {

class AtomicFile {
 public:
  // Creates missing parent folders. The temporary is "<path>.tmp.<host>.<pid>",
  // opened with O_EXCL | O_NOFOLLOW.
  explicit AtomicFile(const std::filesystem::path& path);
  ~AtomicFile();  // removes the temporary unless Commit() succeeded
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(const void* data, size_t num_bytes);
  void Write(std::string_view text) { Write(text.data(), text.size()); }

  // Publishes the file. Throws Error(kOutOfResources) on a full disk or quota,
  // naming the file; nothing is left under the final name then.
  void Commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path temporary_;
  int fd_ = -1;
};

void WriteFileAtomically(const std::filesystem::path& path, std::string_view contents);

// Removes temporaries below `folder` whose process is gone (same host) .
void RemoveStaleTemporaries(const std::filesystem::path& folder);

}  // namespace hpm
