// What a run did, image by image, for the summary and the run record.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/controller/stage_runner.h"

#include <map>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

class RunStatistics {
 public:
  // stage_name: as in StagePlan::NameOf(). Images that are only sources count
  // for the work, not for the images.
  void Add(const std::string& image,
           bool is_reference,
           const Stage& stage,
           const std::string& stage_name,
           const Camera& camera,
           const StageResult& result);
  void AddFailure(const std::string& image) { failed_.insert(image); }

  bool HasFailed(const std::string& image) const {
    return failed_.count(image) > 0;
  }
  bool AnyFailed() const { return !failed_.empty(); }
  bool AnyComputed() const { return !computed_.empty(); }
  // Images that are only sources count here.
  bool AnyWork() const { return !worked_on_.empty(); }

  // problem_images: names of all reference images of the run.
  RunSummary Summarize(const std::vector<std::string>& problem_images,
                       const std::string& backend,
                       double seconds) const;

  // By image, of the final maps that were computed.
  const std::map<std::string, FilterLosses>& losses() const { return losses_; }

  nlohmann::json Record(const ControllerOptions& options,
                        const RunSummary& summary) const;

 private:
  nlohmann::json images_;
  std::set<std::string> computed_;
  std::set<std::string> worked_on_;  // these and sources
  std::set<std::string> failed_;
  PhaseTimes seconds_;
  double evaluations_ = 0;      // matching costs, all images and stages
  double pixels_ = 0;           // of all images computed, at full resolution
  double valid_share_sum_ = 0;  // over final maps
  int num_final_maps_ = 0;
  std::map<std::string, FilterLosses> losses_;
};

}  // namespace hpm
