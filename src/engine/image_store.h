// Where a run takes its pictures from: files with a cache (the controller), or
// memory (memory_stores.h).
#pragma once

#include "src/base/error.h"
#include "src/image/gray_image.h"

#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace hpm {

// Pictures that only reading found to be damaged. The plan of the run counted
// on them, so the run ends with this error when it has read the pictures of a
// stage.
class UnreadableImages : public Error {
 public:
  using Reasons = std::map<int, std::string>;  // by image; at least one

  explicit UnreadableImages(Reasons reasons)
      : Error(ErrorCode::kBadInput, reasons.begin()->second),
        reasons_(std::move(reasons)) {}
  const Reasons& reasons() const { return reasons_; }

 private:
  Reasons reasons_;
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
  // UnreadableImages, which holds all such of the requests, and Error(kUsage)
  // for images it knows nothing of.
  virtual std::vector<std::shared_ptr<const GrayImage>> Images(
      const std::vector<ImageRequest>& requests) = 0;
};

}  // namespace hpm
