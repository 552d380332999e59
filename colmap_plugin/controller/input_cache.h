// Images and depth maps of the workspace, read when needed and kept within a
// bound. All methods may be called from several threads; none reads what
// another is reading already.
#pragma once

#include "colmap_plugin/controller/input_counts.h"
#include "colmap_plugin/controller/lru_cache.h"
#include "colmap_plugin/controller/stages.h"
#include "src/engine/image_store.h"
#include "src/image/gray_image.h"
#include "src/image/inverse_depth_map.h"

#include <functional>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace hpm {

// 1/z of an image's maps, of the camera's size, at the pixel centres of the
// camera halved `more_levels` times.
struct DepthRequest {
  int image = 0;
  Camera camera;
  StageFiles files;
  int more_levels = 0;
};

class InputCache : public ImageStore {
 public:
  // max_decodes: files that one caller may decode at once.
  InputCache(const Workspace& workspace, uint64_t max_bytes, int max_decodes);

  void StartStage(int level) override;
  std::vector<std::shared_ptr<const GrayImage>> Images(
      const std::vector<ImageRequest>& requests) override;

  // Null where the maps are absent or damaged.
  std::vector<std::shared_ptr<const InverseDepthMap>> InverseDepths(
      const std::vector<DepthRequest>& requests);

  // When those of the stage before are of no use any more.
  void ForgetDepths();

  InputCounts counts() const;

 private:
  using Input = std::shared_ptr<const void>;  // GrayImage or InverseDepthMap
  using Key = int64_t;                        // see KeyOf
  enum class IfLoading { kWait, kSkip };      // what another thread is loading
  enum class Keep { kUsed, kSpare };

  // What the cache has, null where that is nothing. Asked for all that a
  // problem needs before any of it is loaded, so that nothing of it is dropped
  // for the rest.
  std::vector<Input> Kept(const std::vector<Key>& keys);
  // What `load` returns or the cache has; null if it is skipped.
  Input Get(Key key,
            IfLoading if_loading,
            Keep keep,
            const std::function<Input()>& load,
            const std::function<uint64_t(const Input&)>& bytes_of);
  std::shared_ptr<const GrayImage> Image(int image,
                                         int level,
                                         IfLoading if_loading,
                                         Keep keep);
  std::shared_ptr<const InverseDepthMap> InverseDepth(
      const DepthRequest& request, IfLoading if_loading);

  const Workspace& workspace_;
  const int max_decodes_;
  int level_ = 0;
  // Held to look up and to keep, not to read: threads decode side by side.
  mutable std::mutex mutex_;
  LruCache<Key, void> inputs_;
  std::map<Key, std::shared_future<Input>> loading_;
  InputCounts counts_;
};

}  // namespace hpm
