#include "colmap_plugin/controller/share_checks.h"

#include "src/base/error.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>

namespace hpm {

void CheckShare(const RunShare& share, const StagePlan& plan) {
  std::vector<std::string> names;
  for (const Stage& stage : plan.stages()) names.push_back(stage.name);
  share.CheckStage(names);
  if (!share.Finishes() || plan.num_open() == 0) return;
  throw Error(kNotReady,
              fmt::format("{} maps are still to be made, so there is nothing "
                          "to finish; hpm_mvs status tells of which stages",
                          plan.num_open()));
}

void CheckInputs(const RunShare& share, const StagePlan& plan, int stage) {
  if (share.IsWhole()) return;
  const std::vector<std::string> missing = plan.MissingInputs(stage);
  if (missing.empty()) return;
  constexpr size_t kMaxNames = 20;
  const auto num_named =
      static_cast<ptrdiff_t>(std::min(kMaxNames, missing.size()));
  const bool are_all = num_named == static_cast<ptrdiff_t>(missing.size());
  throw Error(
      kNotReady,
      fmt::format("stage {} needs the maps of stage {} of {} images that are "
                  "not there yet: {}{}; run that stage of all shards first, "
                  "hpm_mvs status tells how far it is",
                  plan.stages()[stage].name,
                  plan.stages()[stage - 1].name,
                  missing.size(),
                  fmt::join(missing.begin(), missing.begin() + num_named, ", "),
                  are_all ? "" : ", ..."));
}

}  // namespace hpm
