// What a run did, image by image, for the summary and the run record.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/controller/cost_histogram.h"
#include "colmap_plugin/controller/filter_losses.h"
#include "colmap_plugin/controller/stages.h"
#include "src/engine/run_passes.h"

#include <map>
#include <mutex>
#include <optional>
#include <set>
#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

// Of a stage of an image.
struct StageResult {
  double valid_pixel_share = 0;
  double cost_evaluations_per_pixel = 0;
  FilterLosses losses;  // of a final stage
  // Of a final stage: what its maps publish.
  std::optional<CostHistogram> costs;
  PhaseTimes seconds;         // wall, per phase
  PhaseTimes device_seconds;  // of a card, per kind of work
};

nlohmann::json ToJson(const StageResult& result);

// Adding and asking about failures is for several threads at once, the rest is
// for the end.
class RunStatistics {
 public:
  // stage_name: as in StagePlan::NameOf(). Images that are only sources count
  // for the work, not for the images. A map that is made again, after the run
  // was planned anew, takes the place of the one before. Returns whether it is
  // the first result.
  bool Add(const std::string& image,
           bool is_reference,
           const Stage& stage,
           const std::string& stage_name,
           const Camera& camera,
           const StageResult& result);
  // Only references count as failed images; of the others it is known.
  void AddFailure(const std::string& image, bool is_reference);
  bool HasFailed(const std::string& image) const;
  bool AnyFailed() const { return !failed_.empty(); }
  bool AnyComputed() const { return !computed_.empty(); }

  // problem_images: names of all reference images of the run.
  RunSummary Summarize(const std::vector<std::string>& problem_images,
                       const std::string& backend,
                       double seconds) const;

  // By image, of the final maps that were computed.
  const std::map<std::string, FilterLosses>& losses() const { return losses_; }
  // Likewise; of pixels, those with a depth.
  const std::map<std::string, double>& valid_shares() const {
    return valid_shares_;
  }

  nlohmann::json Record(const ControllerOptions& options,
                        const RunSummary& summary) const;

 private:
  mutable std::mutex mutex_;
  nlohmann::json images_;
  std::set<std::string> computed_;
  std::set<std::string> worked_on_;  // these and sources
  std::set<std::string> failed_, failed_sources_;
  PhaseTimes seconds_;
  double evaluations_ = 0;  // matching costs, all images and stages
  double pixels_ = 0;       // of all images computed, at full resolution
  // By image, of final maps.
  std::map<std::string, double> valid_shares_;
  std::map<std::string, FilterLosses> losses_;
  std::map<std::string, CostHistogram> costs_;
};

}  // namespace hpm
