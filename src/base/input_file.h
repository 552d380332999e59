// Opening and reading of untrusted files: only regular files (a FIFO would
// block for ever, a device has no length), length known before anything is
// allocated. Errors that pass are retried (retries.h). Throws UnreadableFile,
// which names the file.
#pragma once

#include "src/base/error.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace hpm {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "COLMAP's files are little-endian and are read and written "
              "without swapping");

// What the file holds is not known, so it may be good.
class UnreadableFile : public Error {
 public:
  explicit UnreadableFile(const std::string& message)
      : Error(ErrorCode::kBadInput, message) {}
};

class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  uint64_t size() const { return size_; }

  // Returns how many bytes were read: less than asked for only at the end of
  // the file. Several threads may read at once.
  size_t ReadAt(uint64_t offset, void* data, size_t num_bytes) const;

 private:
  // Puts the same file, opened anew, in place of the open one. False with errno
  // set if it cannot be opened or is another by now.
  bool Reopen() const;

  std::filesystem::path path_;
  uint64_t size_ = 0;
  int64_t time_ns_ = 0;
  int fd_ = -1;
};

// All of it, if it has at most `max_bytes`; else it throws Error(kBadInput).
std::string ReadWholeFile(const std::filesystem::path& path,
                          uint64_t max_bytes);

}  // namespace hpm
