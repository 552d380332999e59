#include "src/image/decode_picture.h"

#include "src/base/error.h"
#include "src/base/input_file.h"
#include "src/image/image_integrity.h"

#include <cstdint>
#include <new>
#include <string>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

// What OpenCV can be given at once.
constexpr uint64_t kMaxPictureBytes = INT32_MAX;

}  // namespace

// As a whole: decoders take an error of the disk for the end of the file, and
// fill what is missing.
std::string ReadPictureFile(const std::filesystem::path& path) {
  std::string file = ReadWholeFile(path, kMaxPictureBytes);
  if (!IsWholePicture(file)) {
    throw Error(ErrorCode::kBadInput,
                path.string() +
                    ": the end of the file is missing; undistort the images "
                    "again or copy the file again");
  }
  return file;
}

cv::Mat DecodePicture(const std::filesystem::path& path, int flags) {
  const std::string file = ReadPictureFile(path);
  // OpenCV refuses more than 2^30 pixels by itself, from the header. It does
  // not write to the file's bytes.
  const cv::Mat bytes(
      1, static_cast<int>(file.size()), CV_8U, const_cast<char*>(file.data()));
  cv::Mat image;
  try {
    if (!file.empty()) image = cv::imdecode(bytes, flags);
  } catch (const cv::Exception& e) {
    // No fault of the file's.
    if (e.code == cv::Error::StsNoMem) throw std::bad_alloc();
    throw Error(ErrorCode::kBadInput,
                path.string() + ": cannot be decoded (" + e.err +
                    "); convert it to PNG or TIFF with 8 or 16 bits");
  }
  if (image.empty()) {
    throw Error(ErrorCode::kBadInput,
                path.string() +
                    ": damaged or of a kind that cannot be decoded; undistort "
                    "the images again or convert it to JPEG, PNG or TIFF");
  }
  return image;
}

}  // namespace hpm
