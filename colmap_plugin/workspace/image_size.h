// Width, height and depth of an image file as stored (EXIF rotation ignored, as
// COLMAP does), without decoding it where the header can be read here: JPEG,
// PNG, BMP, TIFF. All else is decoded by OpenCV. The file's first bytes decide,
// not its extension.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>

namespace hpm {

// OpenCV's own limits for decoding; anything larger is not an image for us.
inline constexpr int kMaxImageSide = 1 << 20;  // pixels
inline constexpr long long kMaxImagePixels = 1 << 30;

// How many bits a sample has: up to 8, 9 to 16 (no sign), or another number
// (more, floating point, with a sign).
enum class SampleDepth { k8, k16, kOther };

struct ImageSize {
  int width = 0;
  int height = 0;
  SampleDepth depth = SampleDepth::k8;
  bool is_jpeg = false;
  uint64_t file_bytes = 0;
};

// Positive and within the limits above.
bool IsImageSize(unsigned long long width, unsigned long long height);

// Nothing if the file is missing, damaged, not an image or beyond the limits.
std::optional<ImageSize> ReadImageSize(const std::filesystem::path& path);

}  // namespace hpm
