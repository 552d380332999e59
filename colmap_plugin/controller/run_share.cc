#include "colmap_plugin/controller/run_share.h"

#include "src/base/error.h"

#include <algorithm>
#include <cstdint>

#include <fmt/format.h>

namespace hpm {
namespace {

// Which of `count` parts of nearly the same size position i of n is in.
int PartOf(int64_t i, int64_t n, int64_t count) {
  return static_cast<int>(((i + 1) * count - 1) / n);
}

}  // namespace

RunShare::RunShare(const HpmOptions& options) : stage_(options.stage) {
  const std::optional<ShardNumber> number = ParseShard(options.shard);
  if (!number) {
    throw Error(ErrorCode::kUsage,
                fmt::format("--Hpm.shard {} is no shard; give i/n with 0 <= i "
                            "< n, such as 0/3",
                            options.shard));
  }
  shard_ = *number;
  if (options.overwrite && !IsWhole()) {
    throw Error(ErrorCode::kUsage,
                "--Hpm.overwrite 1 goes with all shards and stages only; to "
                "make all maps anew, delete the folder stereo/hpm_mvs/stamps "
                "of the workspace before");
  }
  if (Finishes() && shard_.count > 1) {
    throw Error(ErrorCode::kUsage,
                "--Hpm.stage finish is for all shards at once; leave "
                "--Hpm.shard out");
  }
}

std::vector<bool> RunShare::Problems(const std::vector<StereoProblem>& problems,
                                     int num_images) const {
  const auto num_references = std::count_if(
      problems.begin(), problems.end(), [](const StereoProblem& problem) {
        return problem.is_reference;
      });
  std::vector<bool> mine;
  int64_t reference = 0;
  for (const StereoProblem& problem : problems) {
    const int part = problem.is_reference
                         ? PartOf(reference++, num_references, shard_.count)
                         : PartOf(problem.ref_image, num_images, shard_.count);
    mine.push_back(part == shard_.index);
  }
  return mine;
}

std::string RunShare::RecordName() const {
  if (IsWhole()) return "run.json";
  return fmt::format(
      "run_{}_{}-of-{}.json", stage_, shard_.index, shard_.count);
}

void RunShare::CheckStage(const std::vector<std::string>& stages) const {
  if (stage_ == "all" || Finishes() ||
      std::find(stages.begin(), stages.end(), stage_) != stages.end()) {
    return;
  }
  throw Error(ErrorCode::kUsage,
              fmt::format("--Hpm.stage {} is no stage of this run; give all, "
                          "finish, or one of {}",
                          stage_,
                          fmt::join(stages, ", ")));
}

}  // namespace hpm
