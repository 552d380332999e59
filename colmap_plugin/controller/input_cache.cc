#include "colmap_plugin/controller/input_cache.h"

#include "colmap_plugin/controller/ray_convention.h"
#include "src/base/error.h"
#include "src/image/load_image.h"
#include "src/image/shrink_image.h"

#include <utility>

namespace hpm {
namespace {

constexpr uint64_t kImageShare = 1 + kInverseDepthBytes;

}  // namespace

InputCache::InputCache(const Workspace& workspace,
                       uint64_t max_bytes,
                       LogSink log)
    : workspace_(workspace),
      log_(std::move(log)),
      images_(max_bytes / kImageShare),
      depths_(max_bytes - max_bytes / kImageShare) {}

std::shared_ptr<const GrayImage> InputCache::Image(int image) {
  int level;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (unreadable_.count(image) > 0) return nullptr;
    if (auto cached = images_.Find(image)) return cached;
    level = level_;
  }
  try {
    const Camera& camera = workspace_.camera(image);
    GrayImage full =
        LoadGrayImage(workspace_.ImagePath(image), camera.width, camera.height);
    auto loaded = std::make_shared<const GrayImage>(
        level == 0 ? std::move(full) : ShrinkImage(full, level));
    const std::lock_guard<std::mutex> lock(mutex_);
    images_.Insert(image, loaded, loaded->data.size());
    return loaded;
  } catch (const Error& error) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (unreadable_.insert(image).second) {
      log_(LogLevel::kWarning, error.what());
    }
    return nullptr;
  }
}

std::shared_ptr<const InverseDepthMap> InputCache::InverseDepth(
    int image, const Camera& camera, const StageFiles& files) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (auto cached = depths_.Find(image)) return cached;
  }
  try {
    auto inverse = std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(
        ReadHypotheses(files.depth, files.normal, camera), camera));
    const std::lock_guard<std::mutex> lock(mutex_);
    depths_.Insert(image, inverse, inverse->steps.size());
    return inverse;
  } catch (const Error&) {
    return nullptr;
  }
}

void InputCache::StartStage(int level) {
  const std::lock_guard<std::mutex> lock(mutex_);
  depths_.Clear();
  if (level != level_) images_.Clear();
  level_ = level;
}

std::vector<std::string> InputCache::UnreadableImages() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::string> names;
  for (const int image : unreadable_)
    names.push_back(workspace_.ImageName(image));
  return names;
}

}  // namespace hpm
