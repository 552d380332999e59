// Whether a picture's file is all there. Decoders forgive what is missing at
// the end and fill it with grey, which would be matched like a surface.
#pragma once

#include <string_view>

namespace hpm {

// False if the end of the picture is missing, told from the file's own
// structure: JPEG, PNG, BMP, TIFF, WebP. True for anything else, whatever its
// decoder says then. What follows the end does not matter.
bool IsWholePicture(std::string_view bytes);

}  // namespace hpm
