#include "colmap_plugin/controller/input_cache.h"

#include "colmap_plugin/controller/ray_convention.h"
#include "src/image/load_image.h"
#include "src/image/shrink_image.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <utility>

#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

namespace hpm {
namespace {

enum class Kind { kImage, kDepth };

constexpr int64_t kLevels = 32;

int64_t KeyOf(Kind kind, int image, int level) {
  return 2 * (kLevels * image + level) + (kind == Kind::kDepth);
}

// do_one(i) for 0 <= i < size, at most `most` at once. Not by an arena of so
// many threads: oneTBB 2021.8 loses 7 KB with each that goes while other arenas
// work.
template <class DoOne>
void ForEach(size_t size, int most, const DoOne& do_one) {
  std::atomic<size_t> next{0};
  const auto take = [&] {
    return next.fetch_add(1, std::memory_order_relaxed);
  };
  tbb::parallel_for(
      0,
      std::min(most, static_cast<int>(size)),
      [&](int) {
        for (size_t i = take(); i < size; i = take()) do_one(i);
      },
      tbb::simple_partitioner());
}

bool IsDepth(int64_t key) { return key % 2 != 0; }
int LevelOf(int64_t key) { return static_cast<int>(key / 2 % kLevels); }

}  // namespace

InputCache::InputCache(const Workspace& workspace,
                       uint64_t max_bytes,
                       int max_decodes)
    : workspace_(workspace), max_decodes_(max_decodes), inputs_(max_bytes) {}

std::vector<std::shared_ptr<const GrayImage>> InputCache::Images(
    const std::vector<ImageRequest>& requests) {
  std::vector<std::shared_ptr<const GrayImage>> images;
  std::vector<Key> keys;
  keys.reserve(requests.size());
  for (const ImageRequest& request : requests) {
    keys.push_back(
        KeyOf(Kind::kImage, request.image, level_ + request.more_levels));
  }
  for (const Input& kept : Kept(keys))
    images.push_back(std::static_pointer_cast<const GrayImage>(kept));
  const auto get = [&](size_t i, IfLoading if_loading) {
    images[i] = Image(requests[i].image,
                      level_ + requests[i].more_levels,
                      if_loading,
                      Keep::kUsed);
  };
  // First what nobody else is loading, so that several callers share the work.
  ForEach(requests.size(), max_decodes_, [&](size_t i) {
    try {
      if (images[i] == nullptr) get(i, IfLoading::kSkip);
    } catch (const UnreadableImages&) {
      // Collected below, with those that others are loading.
    }
  });
  UnreadableImages::Reasons unreadable;
  for (size_t i = 0; i < requests.size(); ++i) {
    if (images[i] != nullptr || unreadable.count(requests[i].image) > 0)
      continue;
    try {
      get(i, IfLoading::kWait);
    } catch (const UnreadableImages& error) {
      unreadable.insert(error.reasons().begin(), error.reasons().end());
    }
  }
  if (!unreadable.empty()) throw UnreadableImages(std::move(unreadable));
  return images;
}

std::vector<std::shared_ptr<const InverseDepthMap>> InputCache::InverseDepths(
    const std::vector<DepthRequest>& requests) {
  std::vector<std::shared_ptr<const InverseDepthMap>> maps;
  std::vector<Key> keys;
  keys.reserve(requests.size());
  for (const DepthRequest& request : requests)
    keys.push_back(KeyOf(Kind::kDepth, request.image, request.more_levels));
  for (const Input& kept : Kept(keys))
    maps.push_back(std::static_pointer_cast<const InverseDepthMap>(kept));
  // One after the other: all threads share the pixels of one.
  for (const IfLoading if_loading : {IfLoading::kSkip, IfLoading::kWait}) {
    for (size_t i = 0; i < requests.size(); ++i) {
      if (maps[i] == nullptr) maps[i] = InverseDepth(requests[i], if_loading);
    }
  }
  return maps;
}

void InputCache::StartStage(int level) {
  const std::lock_guard<std::mutex> lock(mutex_);
  inputs_.EraseIf([&](Key key) {
    return !IsDepth(key) && level != level_ && LevelOf(key) > 0;
  });
  level_ = level;
}

void InputCache::ForgetDepths() {
  const std::lock_guard<std::mutex> lock(mutex_);
  inputs_.EraseIf([](Key key) { return IsDepth(key); });
}

InputCounts InputCache::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return counts_;
}

std::vector<InputCache::Input> InputCache::Kept(const std::vector<Key>& keys) {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<Input> inputs;
  inputs.reserve(keys.size());
  for (const Key key : keys) inputs.push_back(inputs_.Find(key));
  return inputs;
}

InputCache::Input InputCache::Get(
    Key key,
    IfLoading if_loading,
    Keep keep,
    const std::function<Input()>& load,
    const std::function<uint64_t(const Input&)>& bytes_of) {
  std::promise<Input> promise;
  {
    std::unique_lock<std::mutex> lock(mutex_);
    if (Input cached =
            keep == Keep::kUsed ? inputs_.Find(key) : inputs_.Peek(key)) {
      return cached;
    }
    const auto [it, is_new] =
        loading_.try_emplace(key, std::shared_future<Input>());
    if (!is_new) {
      if (if_loading == IfLoading::kSkip) return nullptr;
      const std::shared_future<Input> loading = it->second;
      lock.unlock();
      return loading.get();
    }
    it->second = promise.get_future().share();
    counts_.images += !IsDepth(key) && LevelOf(key) == 0;
    counts_.depth_maps += IsDepth(key);
  }
  Input input;
  std::exception_ptr failure;
  try {
    // A thread that waits for others within must not begin to load something
    // else: that could wait for this.
    tbb::this_task_arena::isolate([&] { input = load(); });
  } catch (...) {
    failure = std::current_exception();
  }
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    loading_.erase(key);
    if (input != nullptr) {
      const uint64_t num_bytes = bytes_of(input);
      if (keep == Keep::kUsed) {
        inputs_.Insert(key, input, num_bytes);
      } else {
        inputs_.InsertSpare(key, input, num_bytes);
      }
    }
  }
  if (failure != nullptr) {
    promise.set_exception(failure);
    std::rethrow_exception(failure);
  }
  promise.set_value(input);
  return input;
}

std::shared_ptr<const GrayImage> InputCache::Image(int image,
                                                   int level,
                                                   IfLoading if_loading,
                                                   Keep keep) {
  const auto load = [&]() -> Input {
    if (level > 0) {
      // Kept if there is room: finer levels need it, too.
      return std::make_shared<const GrayImage>(
          ShrinkImage(*Image(image, 0, IfLoading::kWait, Keep::kSpare), level));
    }
    const Camera& camera = workspace_.camera(image);
    try {
      return std::make_shared<const GrayImage>(
          LoadGrayImage(workspace_.ImagePath(image),
                        camera.width,
                        camera.height,
                        workspace_.Decoding(image)));
    } catch (const Error& error) {
      throw UnreadableImages({{image, error.what()}});
    }
  };
  return std::static_pointer_cast<const GrayImage>(
      Get(KeyOf(Kind::kImage, image, level),
          if_loading,
          keep,
          load,
          [](const Input& input) {
            return static_cast<const GrayImage*>(input.get())->data.size();
          }));
}

std::shared_ptr<const InverseDepthMap> InputCache::InverseDepth(
    const DepthRequest& request, IfLoading if_loading) {
  const auto load = [&]() -> Input {
    try {
      return std::make_shared<const InverseDepthMap>(
          ReadInverseDepths(request.files.depth,
                            request.files.normal,
                            request.camera,
                            request.more_levels));
    } catch (const Error&) {
      return nullptr;
    }
  };
  return std::static_pointer_cast<const InverseDepthMap>(Get(
      KeyOf(Kind::kDepth, request.image, request.more_levels),
      if_loading,
      Keep::kUsed,
      load,
      [](const Input& input) {
        return static_cast<const InverseDepthMap*>(input.get())->steps.size();
      }));
}

}  // namespace hpm
