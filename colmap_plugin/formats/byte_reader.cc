#include "colmap_plugin/formats/byte_reader.h"

#include <algorithm>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr size_t kBufferSize = 1 << 18;
// Linux refuses longer paths, so a longer name is a damaged one.
constexpr size_t kMaxNameLength = 4095;

}  // namespace

ByteReader::ByteReader(const std::filesystem::path& path)
    : file_(path), buffer_(std::min<uint64_t>(kBufferSize, file_.size())) {}

void ByteReader::CheckCount(uint64_t count,
                            uint64_t record_bytes,
                            const char* what) const {
  if (count > Remaining() / record_bytes) {
    Fail(fmt::format(
        "claims {} {}, but only {} bytes follow", count, what, Remaining()));
  }
}

std::string ByteReader::ReadName() {
  std::string name;
  while (const char c = Read<char>()) {
    if (name.size() == kMaxNameLength) Fail("the name has no end");
    name.push_back(c);
  }
  return name;
}

void ByteReader::Skip(uint64_t num_bytes) {
  if (num_bytes > Remaining()) Fail("the file ends in the middle of a record");
  offset_ += num_bytes;
}

void ByteReader::CheckAtEnd() const {
  if (Remaining() > 0) {
    FailAt(offset_,
           fmt::format("{} bytes follow after the last record", Remaining()));
  }
}

std::string ByteReader::Message(uint64_t place, const std::string& what) const {
  return fmt::format(
      "{}: {} (byte {}); the file is damaged, export the model again",
      file_.path().string(),
      what,
      place);
}

const char* ByteReader::Take(size_t num_bytes) {
  if (num_bytes > Remaining()) Fail("the file ends in the middle of a record");
  const bool is_buffered = offset_ >= buffer_offset_ &&
                           offset_ + num_bytes <= buffer_offset_ + buffer_size_;
  if (!is_buffered) {
    buffer_offset_ = offset_;
    buffer_size_ = file_.ReadAt(offset_, buffer_.data(), buffer_.size());
    if (buffer_size_ < num_bytes)
      Fail("the file became shorter while it was read");
  }
  const char* bytes = buffer_.data() + (offset_ - buffer_offset_);
  offset_ += num_bytes;
  return bytes;
}

}  // namespace hpm
