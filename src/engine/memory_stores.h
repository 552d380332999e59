// Pictures and maps of a run in memory: for programs that have no workspace,
// for tests and benchmarks, for scenes that are small enough.
#pragma once

#include "src/engine/image_store.h"
#include "src/engine/map_store.h"

#include <map>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace hpm {

class MemoryImageStore : public ImageStore {
 public:
  // images[i]: the picture of image i, of its camera's size.
  explicit MemoryImageStore(std::vector<GrayImage> images);

  void StartStage(int level) override;
  std::vector<std::shared_ptr<const GrayImage>> Images(
      const std::vector<ImageRequest>& requests) override;

 private:
  std::vector<std::shared_ptr<const GrayImage>> images_;
  int level_ = 0;
  std::mutex mutex_;  // of halved_
  // By image and level, of the current stage.
  std::map<std::pair<int, int>, std::shared_ptr<const GrayImage>> halved_;
};

// Keeps the planes of one stage while the next is computed, and the whole maps
// of the last.
class MemoryMapStore : public MapStore {
 public:
  // Keeps a reference to the problems.
  explicit MemoryMapStore(const std::vector<Problem>& problems);

  bool IsNeeded(int, int) const override { return true; }
  void StartStage(int stage) override;
  bool ReadPlanes(int stage, int problem, std::vector<Plane>* planes) override;
  std::vector<SourceDepth> ReadSourceDepths(int stage, int problem) override;
  void Write(int stage, int problem, StageOutput* output) override;

  // Of the last stage; null if the problem failed. Pixels that a filter took
  // have distance 0.
  const HypothesisMap* map(int problem) const;

 private:
  struct Result {
    HypothesisMap map;
    Camera camera;  // of its size
    bool is_there = false;
    bool is_complete = false;
  };
  const Result* Find(int stage, int problem) const;
  std::shared_ptr<const InverseDepthMap> Depth(int problem, int more_levels);

  const std::vector<Problem>& problems_;
  std::map<int, int> problem_of_image_;
  int stage_ = -1;
  std::vector<Result> before_, now_;  // of stage_ - 1 and stage_
  std::mutex mutex_;                  // of depths_
  // Of before_, by problem and level.
  std::map<std::pair<int, int>, std::shared_ptr<const InverseDepthMap>> depths_;
};

}  // namespace hpm
