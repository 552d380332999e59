#include "src/image/image_integrity.h"

#include <algorithm>
#include <cstdint>

namespace hpm {
namespace {

// Reads of untrusted bytes; beyond the end they give zeros and ok() is false.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}

  bool ok() const { return ok_; }
  uint64_t size() const { return bytes_.size(); }

  uint64_t At(uint64_t offset, uint64_t num_bytes, bool big_endian) {
    if (offset > size() || size() - offset < num_bytes) {
      ok_ = false;
      return 0;
    }
    uint64_t value = 0;
    for (uint64_t i = 0; i < num_bytes; ++i) {
      const uint64_t shift = 8 * (big_endian ? num_bytes - 1 - i : i);
      value |= uint64_t{static_cast<uint8_t>(bytes_[offset + i])} << shift;
    }
    return value;
  }

  // The offset of the marker (0xff and a byte that is neither of the coded data
  // nor a filler) at or after `offset`; size() if there is none.
  uint64_t FindMarker(uint64_t offset) const {
    while (offset < size()) {
      offset = bytes_.find('\xff', offset);
      if (offset >= size() - 1) return size();
      const auto byte = static_cast<uint8_t>(bytes_[offset + 1]);
      const bool is_coded =
          byte == 0 || byte == 0x01 || (byte >= 0xd0 && byte <= 0xd7);
      if (byte != 0xff && !is_coded) return offset;
      ++offset;
    }
    return size();
  }

 private:
  std::string_view bytes_;
  bool ok_ = true;
};

// Segments and coded data until the end of the image. Pictures within segments
// (thumbnails) are passed over with them.
bool IsWholeJpeg(Bytes& bytes) {
  uint64_t offset = 2;
  while (true) {
    offset = bytes.FindMarker(offset);
    const uint64_t marker = bytes.At(offset, 2, true) & 0xff;
    if (!bytes.ok()) return false;
    if (marker == 0xd9) return true;
    offset += 2 + bytes.At(offset + 2, 2, true);
  }
}

bool IsWholePng(Bytes& bytes) {
  constexpr uint64_t kEnd = 0x49454e44;  // "IEND"
  for (uint64_t offset = 8; bytes.ok();) {
    const uint64_t length = bytes.At(offset, 4, true);
    const uint64_t type = bytes.At(offset + 4, 4, true);
    bytes.At(offset + 8 + length, 4, true);  // its checksum
    if (bytes.ok() && type == kEnd) return true;
    offset += 12 + length;
  }
  return false;
}

bool IsWholeBmp(Bytes& bytes) {
  constexpr uint64_t kOldHeader = 12;
  if (bytes.At(14, 4, false) == kOldHeader) return true;
  const uint64_t compression = bytes.At(30, 4, false);
  constexpr uint64_t kRgb = 0, kBitFields = 3;
  if (compression != kRgb && compression != kBitFields) return true;
  const uint64_t width = bytes.At(18, 4, false);
  const auto signed_height = static_cast<int32_t>(bytes.At(22, 4, false));
  const uint64_t height = static_cast<uint64_t>(
      signed_height < 0 ? -int64_t{signed_height} : int64_t{signed_height});
  const uint64_t row_bytes = (width * bytes.At(28, 2, false) + 31) / 32 * 4;
  const uint64_t data = bytes.At(10, 4, false);
  return bytes.ok() && data <= bytes.size() &&
         (row_bytes == 0 || height <= (bytes.size() - data) / row_bytes);
}

// All strips or tiles of the first picture lie within the file (TIFF 6.0).
bool IsWholeTiff(Bytes& bytes, bool big_endian) {
  constexpr uint64_t kStrips = 273, kStripBytes = 279, kTiles = 324,
                     kTileBytes = 325, kShort = 3;
  struct Values {
    uint64_t offset = 0;
    uint64_t count = 0;
    int value_bytes = 4;
  };
  const uint64_t directory = bytes.At(4, 4, big_endian);
  const uint64_t num_entries = bytes.At(directory, 2, big_endian);
  Values begins, lengths;
  for (uint64_t i = 0; i < num_entries && bytes.ok(); ++i) {
    const uint64_t entry = directory + 2 + 12 * i;
    const uint64_t tag = bytes.At(entry, 2, big_endian);
    Values values;
    values.value_bytes = bytes.At(entry + 2, 2, big_endian) == kShort ? 2 : 4;
    values.count = bytes.At(entry + 4, 4, big_endian);
    values.offset = values.count * values.value_bytes <= 4
                        ? entry + 8
                        : bytes.At(entry + 8, 4, big_endian);
    if (tag == kStrips || tag == kTiles) begins = values;
    if (tag == kStripBytes || tag == kTileBytes) lengths = values;
  }
  const auto value = [&](const Values& values, uint64_t i) {
    return bytes.At(
        values.offset + i * values.value_bytes, values.value_bytes, big_endian);
  };
  const uint64_t count = std::min(begins.count, lengths.count);
  for (uint64_t i = 0; i < count && bytes.ok(); ++i) {
    if (value(begins, i) + value(lengths, i) > bytes.size()) return false;
  }
  return bytes.ok();
}

bool IsWholeWebp(Bytes& bytes) {
  constexpr uint64_t kWebp = 0x57454250;  // "WEBP"
  if (bytes.At(8, 4, true) != kWebp) return true;
  return bytes.ok() && 8 + bytes.At(4, 4, false) <= bytes.size();
}

}  // namespace

bool IsWholePicture(std::string_view file) {
  Bytes bytes(file);
  const uint64_t magic = bytes.At(0, 4, true);
  if (!bytes.ok()) return true;  // the decoder's to judge
  if (magic >> 16 == 0xffd8) return IsWholeJpeg(bytes);
  if (magic == 0x89504e47) return IsWholePng(bytes);
  if (magic >> 16 == 0x424d) return IsWholeBmp(bytes);
  if (magic == 0x49492a00) return IsWholeTiff(bytes, /*big_endian=*/false);
  if (magic == 0x4d4d002a) return IsWholeTiff(bytes, /*big_endian=*/true);
  if (magic == 0x52494646) return IsWholeWebp(bytes);  // "RIFF"
  return true;
}

}  // namespace hpm
