#include "colmap_plugin/controller/run_statistics.h"

#include "colmap_plugin/options/option_record.h"
#include "src/base/platform/memory.h"

namespace hpm {

nlohmann::json ToJson(const StageResult& result) {
  nlohmann::json json = {
      {"valid_pixel_share", result.valid_pixel_share},
      {"filter_losses", ToJson(result.losses)},
      {"cost_evaluations_per_pixel", result.cost_evaluations_per_pixel},
      {"seconds", result.seconds}};
  if (result.costs) json["cost_histogram"] = ToJson(*result.costs);
  if (!result.device_seconds.empty())
    json["device_seconds"] = result.device_seconds;
  return json;
}

bool RunStatistics::Add(const std::string& image,
                        bool is_reference,
                        const Stage& stage,
                        const std::string& stage_name,
                        const Camera& camera,
                        const StageResult& result) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const bool is_first = worked_on_.empty();
  const double size = static_cast<double>(camera.width) * camera.height;
  evaluations_ += result.cost_evaluations_per_pixel * size;
  if (is_reference) computed_.insert(image);
  if (worked_on_.insert(image).second) {
    pixels_ += size * static_cast<double>(1 << (2 * stage.spec.level));
  }
  if (stage.is_final) {
    valid_shares_[image] = result.valid_pixel_share;
    losses_[image] = result.losses;
    if (result.costs) costs_[image] = *result.costs;
  }
  for (const auto& [phase, time] : result.seconds) seconds_[phase] += time;
  images_[image][stage_name] = ToJson(result);
  return is_first;
}

void RunStatistics::AddFailure(const std::string& image, bool is_reference) {
  const std::lock_guard<std::mutex> lock(mutex_);
  (is_reference ? failed_ : failed_sources_).insert(image);
}

bool RunStatistics::HasFailed(const std::string& image) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return failed_.count(image) + failed_sources_.count(image) > 0;
}

RunSummary RunStatistics::Summarize(
    const std::vector<std::string>& problem_images,
    const std::string& backend,
    double seconds) const {
  RunSummary summary;
  summary.num_problems = static_cast<int>(problem_images.size());
  summary.num_computed = static_cast<int>(computed_.size());
  for (const std::string& image : problem_images) {
    if (computed_.count(image) == 0 && !HasFailed(image)) ++summary.num_kept;
  }
  summary.failed.assign(failed_.begin(), failed_.end());
  summary.seconds = seconds;
  if (!valid_shares_.empty()) {
    const auto num_maps = static_cast<double>(valid_shares_.size());
    double sum = 0;
    for (const auto& [image, share] : valid_shares_) sum += share;
    summary.valid_pixel_share = sum / num_maps;
    for (const auto& [image, losses] : losses_) {
      for (const auto& [criterion, share] : losses)
        summary.filter_losses[criterion] += share / num_maps;
    }
  }
  if (pixels_ > 0) summary.cost_evaluations_per_pixel = evaluations_ / pixels_;
  summary.peak_memory_bytes = PeakMemoryBytes();
  summary.backend = backend;
  return summary;
}

nlohmann::json RunStatistics::Record(const ControllerOptions& options,
                                     const RunSummary& summary) const {
  CostHistogram costs;
  for (const auto& [image, of_image] : costs_) costs += of_image;
  return {
      {"options", OptionRecord(options)},
      {"backend", summary.backend},
      {"seconds", summary.seconds},
      {"seconds_per_phase", seconds_},
      {"cost_evaluations_per_pixel", summary.cost_evaluations_per_pixel},
      {"valid_pixel_share",
       summary.valid_pixel_share ? nlohmann::json(*summary.valid_pixel_share)
                                 : nlohmann::json()},
      {"filter_losses", ToJson(summary.filter_losses)},
      {"cost_histogram", ToJson(costs)},
      {"peak_memory_bytes", summary.peak_memory_bytes},
      {"images_decoded", summary.inputs_read.images},
      {"depth_maps_read", summary.inputs_read.depth_maps},
      {"images_computed", summary.num_computed},
      {"sources_computed", worked_on_.size() - computed_.size()},
      {"images_kept", summary.num_kept},
      {"images_failed", summary.failed},
      {"warnings", summary.warnings},
      {"images", images_}};
}

}  // namespace hpm
