// Decoding of photographs (OpenCV), limited before anything large is allocated.
#pragma once

#include "src/image/gray_image.h"

#include <filesystem>
#include <optional>

namespace hpm {

// Of the grey values of images with more than 8 bits.
struct GreyRange {
  double low = 0;
  double high = 0;
};

// How a file becomes an 8-bit grey image; whoever keeps results must keep this
// with them.
struct ImageDecoding {
  // low becomes 1 and high 255, values beyond go to the ends; no value (0, NaN)
  // becomes 0. Without: 16-bit samples lose their lower byte.
  std::optional<GreyRange> stretch;
  // Decode at 1/reduction of the file's size (JPEG only; 1, 2, 4, 8), which
  // must be known then: the decoder rounds it up.
  int reduction = 1;
  int file_width = 0;
  int file_height = 0;
  // Of the size of the file, 0 = ignored; see gaps.h.
  std::filesystem::path mask;
};

// The largest reduction that loses nothing of an image that is shrunk to width
// x height anyway.
int ReductionFor(int file_width, int file_height, int width, int height);

// Grey value = round(0.2126 R + 0.7152 G + 0.0722 B) as COLMAP; alpha dropped,
// EXIF rotation ignored. Resampled to width x height if the file has another
// size (area averaging when shrinking), masked. Throws Error(kBadInput) naming
// the file if it is missing, damaged or too large.
GrayImage LoadGrayImage(const std::filesystem::path& path,
                        int width,
                        int height,
                        const ImageDecoding& decoding = {});

// All but a thousandth of the pixels at either end; those without a value (0,
// NaN) do not count. Nothing if there are no others or the file cannot be
// decoded.
std::optional<GreyRange> MeasureGreyRange(const std::filesystem::path& path);

}  // namespace hpm
