// The ASCII header "<W>&<H>&<C>&" of map files and consistency graphs. Data
// begin at the byte after the third '&'.
#pragma once

#include "src/base/input_file.h"

#include <string>

namespace hpm {

struct GridHeader {
  int width = 0;
  int height = 0;
  int channels = 0;
  size_t num_bytes = 0;  // length of the header itself
};

// Blanks before a number or an '&' are allowed, as in COLMAP's reader; sizes
// must be positive. Throws Error(kBadInput).
GridHeader ReadGridHeader(const InputFile& file);

std::string FormatGridHeader(int width, int height, int channels);

}  // namespace hpm
