#include "colmap_plugin/formats/grid_header.h"

#include "src/base/error.h"

#include <algorithm>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

namespace hpm {
namespace {

// Three times ten digits, the separators and some blanks.
constexpr size_t kMaxHeaderBytes = 64;

[[noreturn]] void ThrowBadHeader(const InputFile& file) {
  throw Error(ErrorCode::kBadInput,
              fmt::format("{} does not begin with "
                          "\"<width>&<height>&<channels>&\"; delete it and "
                          "run again",
                          file.path().string()));
}

}  // namespace

GridHeader ReadGridHeader(const InputFile& file) {
  char bytes[kMaxHeaderBytes];
  // Never past the known size: what a growing file gains would be counted as
  // header.
  const size_t num_wanted = std::min<uint64_t>(sizeof(bytes), file.size());
  const std::string_view text(bytes, file.ReadAt(0, bytes, num_wanted));
  GridHeader header;
  size_t position = 0;
  for (int* number : {&header.width, &header.height, &header.channels}) {
    position = text.find_first_not_of(" \t\r\n\v\f", position);
    if (position == std::string_view::npos) ThrowBadHeader(file);
    const char* begin = text.data() + position;
    const auto [end, error] =
        std::from_chars(begin, text.data() + text.size(), *number);
    if (error != std::errc() || *number <= 0) ThrowBadHeader(file);
    position = text.find_first_not_of(" \t\r\n\v\f",
                                      static_cast<size_t>(end - text.data()));
    if (position == std::string_view::npos || text[position] != '&')
      ThrowBadHeader(file);
    ++position;
  }
  header.num_bytes = position;
  return header;
}

std::string FormatGridHeader(int width, int height, int channels) {
  return fmt::format("{}&{}&{}&", width, height, channels);
}

}  // namespace hpm
