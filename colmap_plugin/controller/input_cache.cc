#include "colmap_plugin/controller/input_cache.h"

#include "colmap_plugin/controller/ray_convention.h"
#include "src/image/load_image.h"
#include "src/image/shrink_image.h"

#include <utility>

namespace hpm {
namespace {

enum class Input { kImage, kDepth };

int64_t KeyOf(Input input, int image, int more_levels) {
  constexpr int64_t kLevels = 32;
  return 2 * (kLevels * image + more_levels) + (input == Input::kDepth);
}

}  // namespace

InputCache::InputCache(const Workspace& workspace, uint64_t max_bytes)
    : workspace_(workspace), inputs_(max_bytes) {}

std::shared_ptr<const GrayImage> InputCache::Image(int image, int more_levels) {
  int level;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (auto cached = inputs_.Find(KeyOf(Input::kImage, image, more_levels)))
      return std::static_pointer_cast<const GrayImage>(cached);
    level = level_ + more_levels;
  }
  try {
    const Camera& camera = workspace_.camera(image);
    GrayImage full = LoadGrayImage(workspace_.ImagePath(image),
                                   camera.width,
                                   camera.height,
                                   workspace_.Decoding(image));
    auto loaded = std::make_shared<const GrayImage>(
        level == 0 ? std::move(full) : ShrinkImage(full, level));
    const std::lock_guard<std::mutex> lock(mutex_);
    inputs_.Insert(
        KeyOf(Input::kImage, image, more_levels), loaded, loaded->data.size());
    return loaded;
  } catch (const Error& error) {
    throw UnreadableImage(image, error.what());
  }
}

std::shared_ptr<const InverseDepthMap> InputCache::InverseDepth(
    int image, const Camera& camera, const StageFiles& files, int more_levels) {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (auto cached = inputs_.Find(KeyOf(Input::kDepth, image, more_levels)))
      return std::static_pointer_cast<const InverseDepthMap>(cached);
  }
  try {
    auto inverse = std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(
        ReadInverseDepths(files.depth, files.normal, camera, more_levels)));
    const std::lock_guard<std::mutex> lock(mutex_);
    inputs_.Insert(KeyOf(Input::kDepth, image, more_levels),
                   inverse,
                   inverse->steps.size());
    return inverse;
  } catch (const Error&) {
    return nullptr;
  }
}

void InputCache::StartStage(int level) {
  const std::lock_guard<std::mutex> lock(mutex_);
  inputs_.Clear();
  level_ = level;
}

}  // namespace hpm
