// Where the files of the images lie, and what is wrong with those that cannot
// be used: one line per kind of fault, however many images it hits.
#pragma once

#include "colmap_plugin/workspace/image_size.h"
#include "src/base/log.h"

#include <filesystem>
#include <optional>
#include <string>

namespace hpm {

struct ImageFile {
  // As COLMAP looks for it; or with '/' in place of the backslashes of Windows,
  // if only that exists.
  std::filesystem::path path;
  bool exists = false;
  std::optional<ImageSize> size;  // where the header tells it
};

ImageFile FindImageFile(const std::filesystem::path& folder,
                        const std::string& name);

// For a file that does not exist: what may have become of it (the folder is
// missing, a link leads nowhere, another case or extension, a path of another
// machine in the name), and what to do.
std::string WhyMissing(const std::filesystem::path& folder,
                       const std::string& name);

// Whether an image of this size can be the camera's at another scale, each side
// rounded to whole pixels.
bool SameProportions(const ImageSize& camera, const ImageSize& image);

// Whether the image is so much larger that its header must be wrong.
bool IsFarLarger(const ImageSize& camera, const ImageSize& image);

// Counts images with one fault and keeps the first as the example.
class ImageFault {
 public:
  void Add(const std::string& example) {
    if (num_++ == 0) first_ = example;
  }
  int num() const { return num_; }
  const std::string& first() const { return first_; }
  // "3 of 8 images <what>, the first: <example>"
  std::string Line(int num_images, const std::string& what) const;

 private:
  int num_ = 0;
  std::string first_;
};

}  // namespace hpm
