// Pixels of an image that show nothing: masked by the user, or the black border
// that undistortion leaves. They are not estimated, and no pixel is matched
// where they are.
#pragma once

#include "src/image/gray_image.h"

#include <filesystem>

namespace hpm {

// Where a mask of the same size is 0 the image gets 0, and 1 in place of 0
// elsewhere. An image without such a pixel stays as it is.
void ApplyMask(const GrayImage& mask, GrayImage* image);

// A mask that is 0 where connected pixels of value 0 reach from the border of
// the image and are more than a thousandth of it; without pixels if there are
// none. Dark things inside of the image are none.
GrayImage BlackBorder(const GrayImage& image);

// Brought to another size; a pixel is masked if most of what it covers is.
GrayImage ResizedMask(const GrayImage& mask, int width, int height);

// Grey values of an image file; throws Error(kBadInput) naming it.
GrayImage LoadMask(const std::filesystem::path& path);

}  // namespace hpm
