// Images and depth maps of the workspace, read when needed and kept within a
// bound; images that cannot be read are remembered and reported once. All
// methods may be called from several threads.
#pragma once

#include "colmap_plugin/controller/stages.h"
#include "src/base/log.h"
#include "src/engine/lru_cache.h"
#include "src/image/gray_image.h"

#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <vector>

namespace hpm {

class InputCache {
 public:
  InputCache(const Workspace& workspace, uint64_t max_bytes, LogSink log);

  // At the size of the camera, halved `level` times; null if the file cannot be
  // read.
  std::shared_ptr<const GrayImage> Image(int image, int level);

  // 1/z at pixel centres of an image's maps; null if they are absent or
  // damaged.
  std::shared_ptr<const std::vector<float>> InverseDepth(
      int image, const Camera& camera, const StageFiles& files);

  // Depth maps belong to one stage: forget those of the stage before.
  void ForgetDepths();

  // Names of the images that could not be read so far.
  std::vector<std::string> UnreadableImages() const;

 private:
  const Workspace& workspace_;
  LogSink log_;
  // Held to look up and to keep, not to read: threads decode side by side.
  mutable std::mutex mutex_;
  LruCache<int64_t, GrayImage> images_;  // by image and level
  LruCache<int, std::vector<float>> depths_;
  std::set<int> unreadable_;
};

}  // namespace hpm
