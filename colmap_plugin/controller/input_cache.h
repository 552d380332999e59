// Images and depth maps of the workspace, read when needed and kept within a
// bound; images that cannot be read are remembered and reported once. All
// methods may be called from several threads.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "src/base/log.h"
#include "src/engine/lru_cache.h"
#include "src/image/gray_image.h"
#include "src/image/inverse_depth_map.h"

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace hpm {

class InputCache {
 public:
  InputCache(const Workspace& workspace, uint64_t max_bytes, LogSink log);

  // At the size of the camera, halved as the stage wants it and `more_levels`
  // times more; null if the file cannot be read.
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

  // Names of the images that could not be read so far.
  std::vector<std::string> UnreadableImages() const;

 private:
  const Workspace& workspace_;
  LogSink log_;
  // Held to look up and to keep, not to read: threads decode side by side.
  mutable std::mutex mutex_;
  int level_ = 0;
  LruCache<int64_t, void> inputs_;  // GrayImage or InverseDepthMap; see KeyOf
  std::set<int> unreadable_;
};

}  // namespace hpm
