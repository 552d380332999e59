// Which part of a run's work one process does: a shard of the images, in one
// stage or in all. Others do the rest, at the same time or before.
#pragma once

#include "colmap_plugin/options/options.h"
#include "colmap_plugin/options/shard_number.h"
#include "colmap_plugin/workspace/problem.h"
#include "src/base/error.h"

#include <string>
#include <vector>

namespace hpm {

// Maps that are needed are not there yet.
constexpr ErrorCode kNotReady{8};

class RunShare {
 public:
  // As --Hpm.shard and --Hpm.stage say. Throws Error(kUsage) for a text that is
  // no shard and for what does not go with a share of the work.
  explicit RunShare(const HpmOptions& options);

  const ShardNumber& shard() const { return shard_; }
  // All shards and all stages.
  bool IsWhole() const { return shard_.count == 1 && stage_ == "all"; }
  // Computes nothing; does what a whole run does when all its maps are there.
  bool Finishes() const { return stage_ == "finish"; }
  bool HasStage(const std::string& name) const {
    return stage_ == "all" || stage_ == name;
  }
  // Whether each problem is the shard's. References are divided in their order,
  // that of overlap: neighbours there share images. Images that are
  // only sources are divided in the order of the model, so that those who plan
  // with other sources agree about the rest.
  std::vector<bool> Problems(const std::vector<StereoProblem>& problems,
                             int num_images) const;
  // Of the run record: runs on shards have their own.
  std::string RecordName() const;
  // Throws Error(kUsage) if the run has no such stage.
  void CheckStage(const std::vector<std::string>& stages) const;

 private:
  ShardNumber shard_;
  std::string stage_;
};

}  // namespace hpm
