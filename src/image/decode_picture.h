// Decoding of a whole file by OpenCV.
#pragma once

#include <filesystem>
#include <string>

namespace cv {
class Mat;
}

namespace hpm {

// The file's bytes. Throws UnreadableFile, or Error(kBadInput) that names the
// file if its end is missing or it is too large.
std::string ReadPictureFile(const std::filesystem::path& path);

// flags: as of cv::imdecode(). Throws UnreadableFile, or Error(kBadInput) that
// names the file if it is damaged, cut short or too large.
cv::Mat DecodePicture(const std::filesystem::path& path, int flags);

}  // namespace hpm
