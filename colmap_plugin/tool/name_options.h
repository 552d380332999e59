// The library's messages with the names of our options (src/base/remedies.h).
#pragma once

#include <string>

namespace hpm {

// "use smaller images" becomes "use smaller images
// (--PatchMatchStereo.max_image_size)".
std::string NameOptions(std::string message);

}  // namespace hpm
