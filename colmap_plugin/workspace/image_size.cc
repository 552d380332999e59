#include "colmap_plugin/workspace/image_size.h"

#include "src/base/error.h"
#include "src/base/input_file.h"

#include <cstdint>
#include <new>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

// What OpenCV can be given at once.
constexpr uint64_t kMaxDecodedBytes = INT32_MAX;

// A file of untrusted bytes. Reading past the end makes it not ok() and gives
// zeros.
class HeaderReader {
 public:
  explicit HeaderReader(const std::filesystem::path& path) : file_(path) {}

  bool ok() const { return ok_; }
  uint64_t file_bytes() const { return file_.size(); }
  void Seek(uint64_t offset) { offset_ = offset; }
  void Skip(uint32_t num_bytes) { offset_ += num_bytes; }

  uint32_t Read(uint32_t num_bytes, bool big_endian) {
    if (!ok_ || offset_ > file_.size() || file_.size() - offset_ < num_bytes)
      ok_ = false;
    if (!ok_) return 0;
    if (offset_ < begin_ || offset_ + num_bytes > begin_ + part_.size()) {
      begin_ = offset_;
      part_.resize(kPartBytes);
      part_.resize(file_.ReadAt(begin_, part_.data(), part_.size()));
      if (part_.size() < num_bytes) ok_ = false;
      if (!ok_) return 0;
    }
    uint32_t value = 0;
    for (uint32_t i = 0; i < num_bytes; ++i) {
      const uint32_t shift = 8 * (big_endian ? num_bytes - 1 - i : i);
      value |= uint32_t{static_cast<uint8_t>(part_[offset_ - begin_ + i])}
               << shift;
    }
    offset_ += num_bytes;
    return value;
  }

 private:
  static constexpr size_t kPartBytes = 4096;

  InputFile file_;
  bool ok_ = true;
  uint64_t offset_ = 0;
  uint64_t begin_ = 0;  // of the part of the file that is here
  std::string part_;
};

std::optional<ImageSize> MakeSize(const HeaderReader& reader,
                                  uint64_t width,
                                  uint64_t height) {
  if (!reader.ok() || !IsImageSize(width, height)) return std::nullopt;
  return ImageSize{static_cast<int>(width), static_cast<int>(height)};
}

// ITU T.81, annex B: segments until the first start of frame.
std::optional<ImageSize> JpegSize(HeaderReader& reader) {
  // Real files have some tens of segments (metadata); the limit ends hostile
  // ones.
  constexpr int kMaxSteps = 10000;
  reader.Seek(2);
  for (int step = 0; step < kMaxSteps && reader.ok(); ++step) {
    if (reader.Read(1, true) != 0xff) return std::nullopt;
    uint32_t marker = reader.Read(1, true);
    for (; marker == 0xff && step < kMaxSteps; ++step)
      marker = reader.Read(1, true);
    if (marker == 0x01 || (marker >= 0xd0 && marker <= 0xd7))
      continue;  // without length
    if (marker == 0xd9 || marker == 0xda)
      return std::nullopt;  // end or scan: too late
    const uint32_t length = reader.Read(2, true);
    if (length < 2) return std::nullopt;
    const bool start_of_frame = marker >= 0xc0 && marker <= 0xcf &&
                                marker != 0xc4 && marker != 0xc8 &&
                                marker != 0xcc;
    if (start_of_frame) {
      reader.Skip(1);  // bits per sample
      const uint32_t height = reader.Read(2, true);
      const uint32_t width = reader.Read(2, true);
      std::optional<ImageSize> size = MakeSize(reader, width, height);
      if (size) size->is_jpeg = true;
      return size;
    }
    reader.Skip(length - 2);
  }
  return std::nullopt;
}

std::optional<ImageSize> PngSize(HeaderReader& reader) {
  reader.Seek(12);
  if (reader.Read(4, true) != 0x49484452u) return std::nullopt;  // "IHDR"
  const uint32_t width = reader.Read(4, true);
  const uint32_t height = reader.Read(4, true);
  std::optional<ImageSize> size = MakeSize(reader, width, height);
  if (size && reader.Read(1, true) == 16) size->depth = SampleDepth::k16;
  return size;
}

std::optional<ImageSize> BmpSize(HeaderReader& reader) {
  reader.Seek(14);
  const uint32_t header_size = reader.Read(4, false);
  if (header_size == 12) {
    const uint32_t width = reader.Read(2, false);
    const uint32_t height = reader.Read(2, false);
    return MakeSize(reader, width, height);
  }
  const uint32_t width = reader.Read(4, false);
  const int64_t height =
      static_cast<int32_t>(reader.Read(4, false));  // negative: top row first
  return MakeSize(
      reader, width, static_cast<uint64_t>(height < 0 ? -height : height));
}

// Of all samples of a pixel the first speaks for the others.
SampleDepth DepthOf(uint32_t bits, uint32_t format) {
  constexpr uint32_t kUnsigned = 1;
  if (bits <= 8) return SampleDepth::k8;  // whatever they mean
  if (format != kUnsigned || bits > 16) return SampleDepth::kOther;
  return SampleDepth::k16;
}

// TIFF 6.0, section 2: ImageWidth, ImageLength, BitsPerSample and SampleFormat
// of the first directory.
std::optional<ImageSize> TiffSize(HeaderReader& reader, bool big_endian) {
  constexpr uint32_t kWidthTag = 256, kHeightTag = 257, kBitsTag = 258,
                     kFormatTag = 339, kShort = 3, kLong = 4;
  reader.Seek(4);
  reader.Seek(reader.Read(4, big_endian));
  const uint32_t num_entries = reader.Read(2, big_endian);
  uint32_t width = 0;
  uint32_t height = 0;
  uint32_t bits = 1;
  uint32_t format = 1;
  std::optional<ImageSize> size;
  // Where they stand if there are too many for the directory.
  uint32_t bits_offset = 0;
  uint32_t format_offset = 0;
  for (uint32_t i = 0; i < num_entries && reader.ok(); ++i) {
    const uint32_t tag = reader.Read(2, big_endian);
    const uint32_t type = reader.Read(2, big_endian);
    const uint32_t count = reader.Read(4, big_endian);
    uint32_t value = 0;
    if (tag == kBitsTag && type == kShort && count > 2) {
      bits_offset = reader.Read(4, big_endian);
    } else if (tag == kFormatTag && type == kShort && count > 2) {
      format_offset = reader.Read(4, big_endian);
    } else if (type == kShort) {
      value = reader.Read(2, big_endian);
      reader.Skip(2);
    } else if (type == kLong) {
      value = reader.Read(4, big_endian);
    } else {
      reader.Skip(4);
    }
    if (tag == kWidthTag) width = value;
    if (tag == kHeightTag) height = value;
    if (tag == kBitsTag && bits_offset == 0) bits = value;
    if (tag == kFormatTag && format_offset == 0) format = value;
    if (!size && width > 0 && height > 0)
      size = MakeSize(reader, width, height);
  }
  if (!size) return std::nullopt;
  const auto read_first = [&](uint32_t offset, uint32_t* value) {
    if (offset == 0 || !reader.ok()) return;
    reader.Seek(offset);
    *value = reader.Read(2, big_endian);
  };
  read_first(bits_offset, &bits);
  read_first(format_offset, &format);
  size->depth = DepthOf(bits, format);
  return size;
}

std::optional<ImageSize> DecodedSize(const std::filesystem::path& path) {
  try {
    std::string file = ReadWholeFile(path, kMaxDecodedBytes);
    const cv::Mat bytes(1, static_cast<int>(file.size()), CV_8U, file.data());
    const cv::Mat image = cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    if (image.empty()) return std::nullopt;
    ImageSize size = {image.cols, image.rows};
    if (image.depth() == CV_16U) size.depth = SampleDepth::k16;
    if (image.depth() > CV_16U) size.depth = SampleDepth::kOther;
    return size;
  } catch (const cv::Exception& e) {
    // No fault of the file's.
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
    return std::nullopt;
  }
}

// By the file's first bytes.
std::optional<ImageSize> SizeFromHeader(HeaderReader& reader) {
  const uint32_t magic = reader.Read(4, true);
  if (!reader.ok()) return std::nullopt;
  if (magic >> 16 == 0xffd8) return JpegSize(reader);
  if (magic == 0x89504e47u) return PngSize(reader);
  if (magic >> 16 == 0x424d) return BmpSize(reader);
  if (magic == 0x49492a00u) return TiffSize(reader, /*big_endian=*/false);
  if (magic == 0x4d4d002au) return TiffSize(reader, /*big_endian=*/true);
  return std::nullopt;
}

}  // namespace

bool IsImageSize(unsigned long long width, unsigned long long height) {
  return width > 0 && height > 0 && width <= kMaxImageSide &&
         height <= kMaxImageSide &&
         width * height <= static_cast<unsigned long long>(kMaxImagePixels);
}

std::optional<ImageSize> ReadImageSize(const std::filesystem::path& path) {
  try {
    HeaderReader reader(path);
    std::optional<ImageSize> size = SizeFromHeader(reader);
    // Too short for anything.
    if (!size && reader.file_bytes() >= 4) size = DecodedSize(path);
    if (size) size->file_bytes = reader.file_bytes();
    return size;
  } catch (const Error&) {
    return std::nullopt;  // missing, a folder, a pipe, unreadable
  }
}

}  // namespace hpm
