// Little-endian fields of an untrusted binary file. Every read is checked
// against the bytes that are left, every count against the least space its
// records need. Errors (kBadInput) name the file and the offset of the record
// at fault.
#pragma once

#include "colmap_plugin/formats/input_cursor.h"
#include "src/base/input_file.h"

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

namespace hpm {

class ByteReader : public InputCursor {
 public:
  explicit ByteReader(const std::filesystem::path& path);

  // Errors name the place where this was last called.
  void BeginRecord() { record_ = offset_; }

  template <class T>
  T Read() {
    static_assert(std::is_arithmetic_v<T>);
    T value;
    std::memcpy(&value, Take(sizeof(T)), sizeof(T));
    return value;
  }

  // Checks that `count` records of at least `record_bytes` each can follow.
  void CheckCount(uint64_t count,
                  uint64_t record_bytes,
                  const char* what) const;

  // Bytes up to a NUL, which is consumed.
  std::string ReadName();

  void Skip(uint64_t num_bytes);

  // Refuses bytes after the last record: they mean that a count or a record is
  // damaged.
  void CheckAtEnd() const;

  uint64_t place() const override { return record_; }

  uint64_t Remaining() const { return file_.size() - offset_; }

 private:
  std::string Message(uint64_t place, const std::string& what) const override;
  // The next bytes, at most the capacity of the buffer; consumed.
  const char* Take(size_t num_bytes);

  InputFile file_;
  uint64_t offset_ = 0;
  uint64_t record_ = 0;
  std::vector<char> buffer_;
  uint64_t buffer_offset_ = 0;  // file offset of buffer_[0]
  size_t buffer_size_ = 0;
};

}  // namespace hpm
