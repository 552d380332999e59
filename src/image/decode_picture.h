// Decoding of a whole file by OpenCV.
#pragma once

#include <filesystem>

namespace cv {
class Mat;
}

namespace hpm {

// flags: as of cv::imdecode(). Throws UnreadableFile, or Error(kBadInput) that
// names the file if it is damaged, cut short or too large.
cv::Mat DecodePicture(const std::filesystem::path& path, int flags);

}  // namespace hpm
