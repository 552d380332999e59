// Where a run takes its pictures from: files with a cache (the controller), or
// memory (memory_stores.h).
#pragma once

#include "src/base/error.h"
#include "src/image/gray_image.h"

#include <memory>
#include <string>
#include <vector>

namespace hpm {

// A picture that only reading found to be damaged. The plan of the run counted
// on it, so the run ends with this error.
class UnreadableImage : public Error {
 public:
  UnreadableImage(int image, const std::string& message)
      : Error(ErrorCode::kBadInput, message), image_(image) {}
  int image() const { return image_; }

 private:
  int image_;
};

// Of the size of the image's camera, halved as the stage wants it and
// `more_levels` times more.
struct ImageRequest {
  int image = 0;
  int more_levels = 0;
};

class ImageStore {
 public:
  virtual ~ImageStore() = default;

  // Between two stages: from now on images are halved `level` times.
  virtual void StartStage(int level) = 0;

  // As many as there are requests; called by several threads at once. Throws
  // UnreadableImage, and Error(kUsage) for images it knows nothing of.
  virtual std::vector<std::shared_ptr<const GrayImage>> Images(
      const std::vector<ImageRequest>& requests) = 0;
};

}  // namespace hpm
