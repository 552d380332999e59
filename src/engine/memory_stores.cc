#include "src/engine/memory_stores.h"

#include "src/image/middle_pixel.h"
#include "src/image/shrink_image.h"

#include <string>

namespace hpm {
namespace {

// 1/z at the pixel centres of the camera halved `more_levels` times.
InverseDepthMap InverseDepthOf(const std::vector<Plane>& planes,
                               const Camera& camera,
                               int more_levels) {
  const Camera coarse = LevelCamera(camera, more_levels);
  const MiddlePixel middle(more_levels);
  std::vector<float> inverse;
  inverse.reserve(static_cast<size_t>(coarse.width) * coarse.height);
  for (int row = 0; row < coarse.height; ++row) {
    for (int col = 0; col < coarse.width; ++col) {
      const size_t at =
          static_cast<size_t>(middle.Of(row, camera.height)) * camera.width +
          middle.Of(col, camera.width);
      inverse.push_back(
          InverseDepthOfBlock(camera, planes[at], middle, col, row));
    }
  }
  return InverseDepthMap::Of(inverse);
}

// What `made` has for the key, else make(). That takes long and all threads, so
// it is done without the mutex: two may make the same, nobody waits.
template <class Made, class Make>
typename Made::mapped_type FindOrMake(const typename Made::key_type& key,
                                      std::mutex* mutex,
                                      Made* made,
                                      const Make& make) {
  {
    const std::lock_guard<std::mutex> lock(*mutex);
    const auto found = made->find(key);
    if (found != made->end()) return found->second;
  }
  typename Made::mapped_type value =
      std::make_shared<typename Made::mapped_type::element_type>(make());
  const std::lock_guard<std::mutex> lock(*mutex);
  return made->emplace(key, std::move(value)).first->second;
}

}  // namespace

MemoryImageStore::MemoryImageStore(std::vector<GrayImage> images) {
  for (GrayImage& image : images)
    images_.push_back(std::make_shared<const GrayImage>(std::move(image)));
}

void MemoryImageStore::StartStage(int level) {
  if (level != level_) halved_.clear();
  level_ = level;
}

std::vector<std::shared_ptr<const GrayImage>> MemoryImageStore::Images(
    const std::vector<ImageRequest>& requests) {
  std::vector<std::shared_ptr<const GrayImage>> images;
  for (const ImageRequest& request : requests) {
    if (request.image < 0 ||
        request.image >= static_cast<int>(images_.size())) {
      throw Error(ErrorCode::kUsage,
                  "image " + std::to_string(request.image) +
                      ": there is no picture of it");
    }
    const auto& full = images_[request.image];
    const int level = level_ + request.more_levels;
    images.push_back(
        level == 0 ? full
                   : FindOrMake({request.image, level}, &mutex_, &halved_, [&] {
                       return ShrinkImage(*full, level);
                     }));
  }
  return images;
}

MemoryMapStore::MemoryMapStore(const std::vector<Problem>& problems)
    : problems_(problems) {
  for (size_t p = 0; p < problems.size(); ++p)
    problem_of_image_[problems[p].image] = static_cast<int>(p);
}

void MemoryMapStore::StartStage(int stage) {
  before_ = std::move(now_);
  now_.clear();
  now_.resize(problems_.size());
  depths_.clear();
  stage_ = stage;
}

const MemoryMapStore::Result* MemoryMapStore::Find(int stage,
                                                   int problem) const {
  const std::vector<Result>& results = stage == stage_ ? now_ : before_;
  if (stage < 0 || stage > stage_ || stage < stage_ - 1 ||
      problem >= static_cast<int>(results.size()) ||
      !results[problem].is_there) {
    return nullptr;
  }
  return &results[problem];
}

bool MemoryMapStore::ReadPlanes(int stage,
                                int problem,
                                std::vector<Plane>* planes) {
  const Result* result = Find(stage, problem);
  if (result == nullptr) {
    throw Error(ErrorCode::kBadInput,
                "image " + std::to_string(problems_[problem].image) +
                    ": the map of the stage before is missing; compute all "
                    "stages in order");
  }
  *planes = result->map.planes;
  return result->is_complete;
}

std::vector<SourceDepth> MemoryMapStore::ReadSourceDepths(int stage,
                                                          int problem) {
  std::vector<SourceDepth> depths;
  for (const ProblemSource& source : problems_[problem].sources) {
    const auto found = problem_of_image_.find(source.image);
    if (found == problem_of_image_.end()) {
      depths.emplace_back();
      continue;
    }
    const Result* result = Find(stage, found->second);
    if (result == nullptr) {
      depths.push_back({nullptr, false});
      continue;
    }
    depths.push_back(
        {Depth(found->second, source.more_levels), result->is_complete});
  }
  return depths;
}

std::shared_ptr<const InverseDepthMap> MemoryMapStore::Depth(int problem,
                                                             int more_levels) {
  return FindOrMake({problem, more_levels}, &mutex_, &depths_, [&] {
    const Result& result = before_[problem];
    return InverseDepthOf(result.map.planes, result.camera, more_levels);
  });
}

void MemoryMapStore::Write(int, int problem, StageOutput* output) {
  HypothesisMap& map = *output->map;
  for (size_t i = 0; i < output->keep.size(); ++i) {
    if (!output->keep[i]) map.planes[i].distance = 0;
  }
  map.Touch();
  Result& result = now_[problem];
  if (output->is_final) {
    result.map = std::move(map);
  } else {
    result.map.width = map.width;
    result.map.height = map.height;
    result.map.planes = std::move(map.planes);
  }
  result.camera = output->views.ref.camera;
  result.is_complete = output->is_complete;
  result.is_there = true;
}

const HypothesisMap* MemoryMapStore::map(int problem) const {
  const Result* result = Find(stage_, problem);
  return result == nullptr ? nullptr : &result->map;
}

}  // namespace hpm
