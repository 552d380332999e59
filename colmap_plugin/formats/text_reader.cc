#include "colmap_plugin/formats/text_reader.h"

#include <algorithm>
#include <cstring>

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr size_t kBufferSize = 1 << 16;
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";

}  // namespace

std::string_view Trim(std::string_view text) {
  constexpr std::string_view kBlanks = " \t\r\n";
  const size_t begin = text.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kBlanks) - begin + 1);
}

LineReader::LineReader(const std::filesystem::path& path)
    : file_(path), buffer_(std::min<uint64_t>(kBufferSize, file_.size())) {}

bool LineReader::Next() {
  raw_line_.clear();
  bool found_end = false;
  while (!found_end) {
    if (buffer_begin_ == buffer_end_) {
      buffer_begin_ = 0;
      buffer_end_ = file_.ReadAt(offset_, buffer_.data(), buffer_.size());
      offset_ += buffer_end_;
      if (buffer_end_ == 0) break;
    }
    const char* begin = buffer_.data() + buffer_begin_;
    const size_t available = buffer_end_ - buffer_begin_;
    const void* newline = std::memchr(begin, '\n', available);
    found_end = newline != nullptr;
    const size_t length =
        found_end
            ? static_cast<size_t>(static_cast<const char*>(newline) - begin)
            : available;
    raw_line_.append(begin, length);
    buffer_begin_ += length + (found_end ? 1 : 0);
  }
  if (!found_end && raw_line_.empty()) return false;
  ++line_number_;
  std::string_view line = raw_line_;
  if (line_number_ == 1 &&
      line.substr(0, kByteOrderMark.size()) == kByteOrderMark) {
    line.remove_prefix(kByteOrderMark.size());
  }
  line_ = Trim(line);
  return true;
}

std::string LineReader::Message(uint64_t place, const std::string& what) const {
  return fmt::format("{}:{}: {}; correct this line or write the file again",
                     file_.path().string(),
                     place,
                     what);
}

std::string_view Words::Next() {
  const size_t end = std::min(rest_.find_first_of(" \t"), rest_.size());
  const std::string_view word = rest_.substr(0, end);
  rest_ = Trim(rest_.substr(end));
  return word;
}

}  // namespace hpm
