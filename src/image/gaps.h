// Pixels of an image that the user masked. They are not estimated, and no pixel
// is matched where they are. Black pixels alone say nothing: borders that
// undistortion leaves look like dark things at the border of a photograph.
#pragma once

#include "src/image/gray_image.h"

#include <filesystem>

namespace hpm {

// Where a mask of the same size is 0 the image gets 0, and 1 in place of 0
// elsewhere. An image without such a pixel stays as it is.
void ApplyMask(const GrayImage& mask, GrayImage* image);

// Of a loaded mask; a pixel is masked if most of what it covers is.
GrayImage ResizedMask(const GrayImage& mask, int width, int height);

// 0 where the samples of an image file are, whatever bits they have, and 255
// elsewhere. Throws Error(kBadInput) naming it.
GrayImage LoadMask(const std::filesystem::path& path);

}  // namespace hpm
