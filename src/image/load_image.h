// Decoding of photographs (OpenCV), limited before anything large is allocated.
#pragma once

#include "src/image/gray_image.h"

#include <filesystem>

namespace hpm {

// Grey value = round(0.2126 R + 0.7152 G + 0.0722 B) as COLMAP; alpha dropped,
// EXIF rotation ignored, 16-bit samples reduced to 8. Resampled to width x
// height if the file has another size (area averaging when shrinking). Throws
// Error(kBadInput) naming the file if it is missing, damaged or too large.
GrayImage LoadGrayImage(const std::filesystem::path& path,
                        int width,
                        int height);

}  // namespace hpm
