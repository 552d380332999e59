#include "colmap_plugin/controller/file_map_store.h"

#include "colmap_plugin/controller/preview.h"
#include "colmap_plugin/controller/ray_convention.h"
#include "colmap_plugin/controller/share_checks.h"
#include "colmap_plugin/formats/consistency_graph.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/file_system.h"
#include "colmap_plugin/workspace/source_level.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/retries.h"
#include "src/engine/phase_timer.h"

#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include <tbb/parallel_invoke.h>

namespace hpm {

FileMapStore::FileMapStore(const Workspace& workspace,
                           const std::vector<StereoProblem>& problems,
                           const ControllerOptions& options,
                           const StagePlan& plan,
                           const RunLock& lock,
                           InputCache* inputs,
                           RunStatistics* statistics,
                           const LogSink& log)
    : workspace_(workspace),
      problems_(problems),
      options_(options),
      plan_(plan),
      lock_(lock),
      inputs_(inputs),
      statistics_(statistics),
      log_(log) {}

bool FileMapStore::IsNeeded(int stage, int problem) const {
  return plan_.IsNeeded(stage, problem) &&
         !statistics_->HasFailed(
             workspace_.ImageName(problems_[problem].ref_image));
}

void FileMapStore::StartStage(int stage) {
  inputs_->ForgetDepths();
  CheckInputs(RunShare(options_.hpm), plan_, stage);
}

bool FileMapStore::ReadPlanes(int stage,
                              int problem,
                              std::vector<Plane>* planes) {
  const int image = problems_[problem].ref_image;
  const StageFiles files = plan_.Files(stage, image);
  const bool is_complete = plan_.HasCompleteMaps(stage, image);
  hpm::ReadPlanes(
      files.depth, files.normal, plan_.CameraOf(stage, image), planes);
  return is_complete;
}

std::vector<SourceDepth> FileMapStore::ReadSourceDepths(int stage,
                                                        int problem) {
  const StereoProblem& p = problems_[problem];
  std::vector<SourceDepth> depths(p.src_images.size());
  std::vector<DepthRequest> requests;
  std::vector<SourceDepth*> requested;
  for (size_t j = 0; j < depths.size(); ++j) {
    const int src = p.src_images[j];
    const bool is_complete = plan_.HasCompleteMaps(stage, src);
    depths[j].is_complete = is_complete || !plan_.GetsMaps(src);
    if (!is_complete && !plan_.HasCurrentMaps(stage, src)) continue;
    requests.push_back({src,
                        plan_.CameraOf(stage, src),
                        plan_.Files(stage, src),
                        SourceLevel(workspace_, p, src)});
    requested.push_back(&depths[j]);
  }
  const auto maps = inputs_->InverseDepths(requests);
  for (size_t i = 0; i < maps.size(); ++i) {
    requested[i]->map = maps[i];
    if (maps[i] == nullptr && plan_.GetsMaps(requests[i].image))
      requested[i]->is_complete = false;
  }
  return depths;
}

void FileMapStore::Write(int stage, int problem, StageOutput* output) {
  StageResult result;
  result.cost_evaluations_per_pixel = output->cost_evaluations_per_pixel;
  result.device_seconds = std::move(output->device_seconds);
  const int image = problems_[problem].ref_image;
  const std::string& name = workspace_.ImageName(image);
  const std::string stage_name = plan_.NameOf(stage, image);
  // Rated only, so that nothing was lost.
  if (!options_.patch_match.filter)
    output->consistent = std::vector<uint32_t>();
  if (!output->consistent.empty()) {
    PhaseTimer timer(&output->seconds, "filter");
    result.losses = CountFilterLosses(output->views,
                                      *output->map,
                                      output->consistent,
                                      output->keep,
                                      output->filter,
                                      output->filter_is_geometric);
    if (!plan_.WritesGraph(stage, image))
      output->consistent = std::vector<uint32_t>();
  }
  {
    PhaseTimer timer(&output->seconds, "write");
    if (plan_.IsPublic(stage, image)) {
      log_(LogLevel::kInfo,
           "Writing " + plan_.stages()[stage].name + " output for " + name);
    }
    lock_.ThrowIfLost();
    RemoveStamp(workspace_.StatePath(), name, stage_name);
    Stamp stamp;
    WriteFiles(stage, problem, *output, &stamp, &result);
    const bool is_complete =
        output->is_complete && plan_.HasSameImages(problem);
    stamp.fingerprint = is_complete
                            ? plan_.FingerprintOf(stage, problem)
                            : plan_.IncompleteFingerprintOf(stage, problem);
    result.seconds = output->seconds;
    stamp.statistics = ToJson(result);
    lock_.ThrowIfLost();
    WriteStamp(workspace_.StatePath(), name, stage_name, stamp);
  }
  result.seconds = std::move(output->seconds);
  const bool is_first = statistics_->Add(name,
                                         problems_[problem].is_reference,
                                         plan_.stages()[stage],
                                         stage_name,
                                         plan_.CameraOf(stage, image),
                                         result);
  // Not before: an image that cannot be decoded changes the plan.
  if (is_first && plan_.ReplacesForeignMaps()) {
    log_(LogLevel::kWarning,
         "maps made with other options, from other images, by another "
         "version or by another program are computed anew");
  }
}

void FileMapStore::WriteFiles(int stage,
                              int problem,
                              const StageOutput& output,
                              Stamp* stamp,
                              StageResult* result) {
  const int image = problems_[problem].ref_image;
  const StageFiles files = plan_.Files(stage, image);
  if (plan_.IsPublic(stage, image)) {
    std::error_code ignored;
    std::filesystem::remove(files.graph, ignored);
    std::filesystem::remove(files.confidence, ignored);
  }
  RetryWriting([&] { WriteMaps(stage, problem, output, stamp, result); });
  if (plan_.WritesGraph(stage, image))
    stamp->files["graph"] = WriteGraph(stage, problem, output);
  if (plan_.WritesConfidence(stage, image))
    stamp->files["confidence"] = WriteConfidence(files, output);
  if (options_.hpm.previews && output.is_final) {
    WritePreviews(workspace_.StereoPath() / "previews",
                  workspace_.ImageName(image),
                  {ReadMap(files.depth), ReadMap(files.normal)});
  }
}

void FileMapStore::WriteMaps(int stage,
                             int problem,
                             const StageOutput& output,
                             Stamp* stamp,
                             StageResult* result) {
  constexpr DepthRange kAll = {0, std::numeric_limits<float>::infinity()};
  const HypothesisMap& map = *output.map;
  const StageFiles files = plan_.Files(stage, problems_[problem].ref_image);
  const bool is_public = plan_.IsPublic(stage, problems_[problem].ref_image);
  const Durability durability =
      is_public ? Durability::kPowerCut : Durability::kProcess;
  if (!is_public) stamp->unsynced_since = UnsyncedSince(workspace_.StatePath());
  MapWriter normal(files.normal, {map.width, map.height, 3}, durability);
  MapWriter depth(files.depth, {map.width, map.height, 1}, durability);
  const WrittenDepths written =
      WritePlanes(map,
                  output.views.ref.camera,
                  output.is_final ? problems_[problem].published : kAll,
                  output.keep.empty() ? nullptr : &output.keep,
                  &depth,
                  &normal);
  // The disk may take both at once; their names appear in this order.
  tbb::parallel_invoke([&] { normal.Flush(); }, [&] { depth.Flush(); });
  stamp->files["normal"] = normal.Commit();
  lock_.ThrowIfLost();
  stamp->files["depth"] = depth.Commit();
  const auto size = static_cast<double>(map.planes.size());
  const size_t num_without = map.planes.size() - written.num_valid;
  result->valid_pixel_share = 1.0 - static_cast<double>(num_without) / size;
  if (output.is_final) result->costs = written.costs;
  if (written.num_dropped > 0) {
    result->losses[FilterCriterion::kRange] =
        static_cast<double>(written.num_dropped) / size;
  }
}

PublishedFile FileMapStore::WriteConfidence(const StageFiles& files,
                                            const StageOutput& output) {
  Map confidence = ReadMap(files.depth);
  for (size_t i = 0; i < confidence.data.size(); ++i) {
    if (confidence.data[i] != 0) confidence.data[i] = output.confidence[i];
  }
  return WriteMap(files.confidence, confidence);
}

PublishedFile FileMapStore::WriteGraph(int stage,
                                       int problem,
                                       const StageOutput& output) const {
  const StereoProblem& p = problems_[problem];
  const StageFiles files = plan_.Files(stage, p.ref_image);
  const int width = output.map->width;
  ConsistencyGraph graph = {width, output.map->height, {}};
  const Map depth = ReadMap(files.depth);
  for (size_t i = 0; i < output.consistent.size(); ++i) {
    const uint32_t consistent = output.consistent[i];
    if (consistent == 0 || depth.data[i] == 0) continue;
    graph.data.push_back(static_cast<int32_t>(i % width));
    graph.data.push_back(static_cast<int32_t>(i / width));
    graph.data.push_back(__builtin_popcount(consistent));
    for (size_t j = 0; j < p.src_images.size(); ++j) {
      if (consistent >> j & 1) graph.data.push_back(p.src_images[j]);
    }
  }
  return WriteConsistencyGraph(files.graph, graph);
}

}  // namespace hpm
