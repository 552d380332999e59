// Opening and reading of untrusted files: only regular files (a FIFO would
// block for ever, a device has no length), length known before anything is
// allocated. Throws Error(kBadInput) naming the file.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

namespace hpm {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__,
              "COLMAP's files are little-endian and are read and written "
              "without swapping");

class InputFile {
 public:
  explicit InputFile(const std::filesystem::path& path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  const std::filesystem::path& path() const { return path_; }
  uint64_t size() const { return size_; }

  // Returns how many bytes were read: less than asked for only at the end of
  // the file.
  size_t ReadAt(uint64_t offset, void* data, size_t num_bytes) const;

 private:
  std::filesystem::path path_;
  uint64_t size_ = 0;
  int fd_ = -1;
};

// What the binary and the text reader share: an error that names file and
// place.
class InputCursor {
 public:
  virtual ~InputCursor() = default;

  // Byte offset of the current record or number of the current line.
  virtual uint64_t place() const = 0;

  [[noreturn]] void FailAt(uint64_t place, const std::string& what) const;
  [[noreturn]] void Fail(const std::string& what) const {
    FailAt(place(), what);
  }

 private:
  // The one-line message: file, what is wrong, place, remedy.
  virtual std::string Message(uint64_t place,
                              const std::string& what) const = 0;
};

}  // namespace hpm
