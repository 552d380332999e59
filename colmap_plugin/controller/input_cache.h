// Images and depth maps of the workspace, read when needed and kept within a
// bound. All methods may be called from several threads.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "src/base/error.h"
#include "src/engine/lru_cache.h"
#include "src/image/gray_image.h"
#include "src/image/inverse_depth_map.h"

#include <memory>
#include <mutex>
#include <string>

namespace hpm {

// An image file that only decoding found to be damaged. The plan of the run
// counted on it.
class UnreadableImage : public Error {
 public:
  UnreadableImage(int image, const std::string& message)
      : Error(ErrorCode::kBadInput, message), image_(image) {}
  int image() const { return image_; }

 private:
  int image_;
};

class InputCache {
 public:
  InputCache(const Workspace& workspace, uint64_t max_bytes);

  // At the size of the camera, halved as the stage wants it and `more_levels`
  // times more. Throws UnreadableImage.
  std::shared_ptr<const GrayImage> Image(int image, int more_levels = 0);

  // 1/z of an image's maps, of the camera's size, at the pixel centres of the
  // camera halved `more_levels` times; null if they are absent or damaged.
  std::shared_ptr<const InverseDepthMap> InverseDepth(int image,
                                                      const Camera& camera,
                                                      const StageFiles& files,
                                                      int more_levels = 0);

  // Forgets the inputs of the stage before; images are halved `level` times
  // from now on.
  void StartStage(int level);

 private:
  const Workspace& workspace_;
  // Held to look up and to keep, not to read: threads decode side by side.
  std::mutex mutex_;
  int level_ = 0;
  LruCache<int64_t, void> inputs_;  // GrayImage or InverseDepthMap; see KeyOf
};

}  // namespace hpm
