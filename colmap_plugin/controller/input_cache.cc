#include "colmap_plugin/controller/input_cache.h"

#include "colmap_plugin/controller/ray_convention.h"
#include "src/base/error.h"
#include "src/image/load_image.h"

#include <utility>

namespace hpm {
namespace {

// A depth map takes four times the bytes of an image.
constexpr uint64_t kImageShare = 5;

}  // namespace

InputCache::InputCache(const Workspace& workspace,
                       uint64_t max_bytes,
                       LogSink log)
    : workspace_(workspace),
      log_(std::move(log)),
      images_(max_bytes / kImageShare),
      depths_(max_bytes - max_bytes / kImageShare) {}

std::shared_ptr<const GrayImage> InputCache::Image(int image) {
  if (unreadable_.count(image) > 0) return nullptr;
  if (auto cached = images_.Find(image)) return cached;
  try {
    const Camera& camera = workspace_.camera(image);
    auto loaded = std::make_shared<const GrayImage>(LoadGrayImage(
        workspace_.ImagePath(image), camera.width, camera.height));
    images_.Insert(image, loaded, loaded->data.size());
    return loaded;
  } catch (const Error& error) {
    log_(LogLevel::kWarning, error.what());
    unreadable_.insert(image);
    return nullptr;
  }
}

std::shared_ptr<const std::vector<float>> InputCache::InverseDepth(
    int image, const StageFiles& files) {
  if (auto cached = depths_.Find(image)) return cached;
  try {
    const Camera& camera = workspace_.camera(image);
    const Map depth = ReadMap(files.depth);
    const Map normal = ReadMap(files.normal);
    if (depth.width != camera.width || depth.height != camera.height ||
        depth.channels != 1 || normal.width != camera.width ||
        normal.height != camera.height || normal.channels != 3) {
      return nullptr;
    }
    auto inverse = std::make_shared<const std::vector<float>>(
        InverseDepths(FromColmapMaps(depth, normal, camera), camera));
    depths_.Insert(image, inverse, inverse->size() * sizeof(float));
    return inverse;
  } catch (const Error&) {
    return nullptr;
  }
}

std::vector<std::string> InputCache::UnreadableImages() const {
  std::vector<std::string> names;
  for (const int image : unreadable_)
    names.push_back(workspace_.ImageName(image));
  return names;
}

}  // namespace hpm
