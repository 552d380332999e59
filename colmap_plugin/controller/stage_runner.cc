#include "colmap_plugin/controller/stage_runner.h"

#include "colmap_plugin/controller/needed_views.h"
#include "colmap_plugin/controller/preview.h"
#include "colmap_plugin/controller/ray_convention.h"
#include "colmap_plugin/formats/consistency_graph.h"
#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/options/method_options.h"
#include "colmap_plugin/workspace/source_level.h"
#include "colmap_plugin/workspace/stamp.h"
#include "src/base/error.h"
#include "src/engine/phase_timer.h"
#include "src/prior/upsample_prior.h"

#include <algorithm>
#include <filesystem>
#include <limits>
#include <system_error>
#include <utility>

#include <fmt/format.h>
#include <tbb/parallel_invoke.h>

namespace hpm {
namespace {

// Hypotheses may leave the range that is searched by this much, as in the
// paper's authors' code.
constexpr float kDepthMinSlack = 0.6f;
constexpr float kDepthMaxSlack = 1.2f;

// By name, so that the order of the images in the model does not matter.
uint64_t RandomKey(int seed, const std::string& image_name) {
  uint64_t key = static_cast<uint64_t>(seed);
  for (const char c : image_name) {
    key = CombineBits(key, static_cast<unsigned char>(c));
  }
  return key;
}

}  // namespace

nlohmann::json ToJson(const StageResult& result) {
  nlohmann::json json = {
      {"valid_pixel_share", result.valid_pixel_share},
      {"filter_losses", ToJson(result.losses)},
      {"cost_evaluations_per_pixel", result.cost_evaluations_per_pixel},
      {"seconds", result.seconds}};
  if (!result.device_seconds.empty())
    json["device_seconds"] = result.device_seconds;
  return json;
}

StageRunner::StageRunner(const Workspace& workspace,
                         const std::vector<StereoProblem>& problems,
                         const Schedule& schedule,
                         const ControllerOptions& options,
                         const StagePlan& plan,
                         const RunLock& lock,
                         InputCache* inputs,
                         Backend* backend,
                         const LogSink& log)
    : workspace_(workspace),
      problems_(problems),
      schedule_(schedule),
      options_(options),
      plan_(plan),
      lock_(lock),
      inputs_(inputs),
      backend_(backend),
      log_(log),
      params_(MakeMethodParams(options)) {}

StageResult StageRunner::Run(int stage,
                             int problem,
                             const RunControl& control) {
  StageResult result;
  ViewSet views;
  {
    PhaseTimer timer(&result.seconds, "read");
    views = MakeViews(stage, problem);
  }
  {
    PhaseTimer timer(&result.seconds, "read");
    StartMap(stage, problem, views);
  }
  RunStage(backend_,
           views,
           schedule_,
           plan_.stages()[stage].spec,
           params_,
           control,
           &map_,
           &result.seconds);
  Publish(stage, problem, views, control, &result);
  return result;
}

ViewSet StageRunner::MakeViews(int stage, int problem) {
  const StereoProblem& p = problems_[problem];
  const std::string& name = workspace_.ImageName(p.ref_image);
  ViewSet views;
  const StageSpec& spec = plan_.stages()[stage].spec;
  src_images_.clear();
  if (!spec.passes.empty()) src_images_ = p.src_images;  // else none is matched
  std::vector<ImageRequest> images = {{p.ref_image, 0}};
  for (const int src : src_images_)
    images.push_back({src, SourceLevel(workspace_, p, src)});
  const auto pictures = inputs_->Images(images);
  views.ref = {plan_.CameraOf(stage, p.ref_image), pictures.front(), nullptr};
  views.depth_min = kDepthMinSlack * p.depth_min;
  views.depth_max = kDepthMaxSlack * p.depth_max;
  views.random_key = RandomKey(options_.random_seed, name);
  for (size_t j = 1; j < images.size(); ++j) {
    const auto [src, level] = images[j];
    views.srcs.push_back({plan_.CameraAround(stage, src, p.ref_image, level),
                          pictures[j],
                          nullptr});
  }
  num_without_maps_ = 0;
  misses_maps_ = stage > 0 && !plan_.HasCompleteMaps(stage - 1, p.ref_image);
  if (spec.geometric) AddDepths(stage, images, &views);
  return views;
}

void StageRunner::AddDepths(int stage,
                            const std::vector<ImageRequest>& images,
                            ViewSet* views) {
  std::vector<DepthRequest> requests;
  std::vector<View*> views_with_maps;
  for (size_t j = 0; j < views->srcs.size(); ++j) {
    const auto [src, level] = images[j + 1];
    if (!plan_.HasCurrentMaps(stage - 1, src)) continue;
    requests.push_back(
        {src, plan_.CameraOf(stage, src), plan_.Files(stage - 1, src), level});
    views_with_maps.push_back(&views->srcs[j]);
  }
  const auto maps = inputs_->InverseDepths(requests);
  for (size_t i = 0; i < maps.size(); ++i)
    views_with_maps[i]->inverse_depth = maps[i];
  for (size_t j = 0; j < views->srcs.size(); ++j) {
    const bool has_maps = views->srcs[j].inverse_depth != nullptr;
    if (!has_maps) ++num_without_maps_;
    const int src = src_images_[j];
    if (plan_.GetsMaps(src) &&
        (!has_maps || !plan_.HasCompleteMaps(stage - 1, src))) {
      misses_maps_ = true;
    }
  }
}

void StageRunner::StartMap(int stage, int problem, const ViewSet& views) {
  const Camera& camera = views.ref.camera;
  const StageSpec& spec = plan_.stages()[stage].spec;
  if (!spec.geometric && !spec.from_coarser) {
    map_.Reset(camera.width, camera.height);
    return;
  }
  map_.ResetAllButPlanes(camera.width, camera.height);
  const int image = problems_[problem].ref_image;
  const StageFiles files = plan_.Files(stage - 1, image);
  const Camera previous = plan_.CameraOf(stage - 1, image);
  if (spec.geometric) {
    ReadPlanes(files.depth, files.normal, previous, &map_.planes);
    return;
  }
  std::vector<Plane> coarse;
  ReadPlanes(files.depth, files.normal, previous, &coarse);
  UpsamplePrior(coarse,
                1,
                camera,
                *views.ref.image,
                {views.depth_min, views.depth_max},
                &map_.planes);
}

void StageRunner::Publish(int stage,
                          int problem,
                          const ViewSet& views,
                          const RunControl& control,
                          StageResult* result) {
  const HypothesisMap& map = map_;
  const Stage& info = plan_.stages()[stage];
  const int image = problems_[problem].ref_image;
  const bool filter = info.is_final && options_.patch_match.filter;
  std::vector<uint32_t> consistent;
  std::vector<bool> keep;
  if (filter) {
    PhaseTimer timer(&result->seconds, "filter");
    const FilterParams params = MakeFilterParams(
        options_.patch_match,
        static_cast<int>(problems_[problem].src_images.size()));
    // Maps of all sources may have failed.
    const bool geometric =
        info.spec.geometric &&
        num_without_maps_ < static_cast<int>(views.srcs.size());
    consistent = backend_->ConsistentViews(map, params, geometric, control);
    keep.resize(consistent.size());
    const NeededViews needed(
        views, map, params, options_.hpm.filter_min_agreement, geometric);
    for (size_t i = 0; i < keep.size(); ++i) {
      const int num = __builtin_popcount(consistent[i]);
      keep[i] = num >= params.min_num_consistent && num >= needed.At(i);
    }
    result->losses =
        CountFilterLosses(views, map, consistent, keep, params, geometric);
    if (!plan_.WritesGraph(stage, image)) consistent = std::vector<uint32_t>();
  }
  if (!info.spec.passes.empty()) {
    result->cost_evaluations_per_pixel =
        static_cast<double>(backend_->num_cost_evaluations()) /
        static_cast<double>(map.planes.size());
    result->device_seconds = backend_->DeviceSeconds();
  }
  // Before the maps are made here and the next problem's inputs are read.
  backend_->ForgetViews();

  PhaseTimer timer(&result->seconds, "write");
  const std::string& name = workspace_.ImageName(image);
  const bool is_public = plan_.IsPublic(stage, image);
  const std::string stage_name = plan_.NameOf(stage, image);
  if (is_public) {
    log_(LogLevel::kInfo, "Writing " + info.name + " output for " + name);
  }
  const StageFiles files = plan_.Files(stage, image);
  lock_.ThrowIfLost();
  RemoveStamp(workspace_.StatePath(), name, stage_name);
  if (is_public) {
    std::error_code ignored;
    std::filesystem::remove(files.graph, ignored);
  }
  Stamp stamp;
  constexpr DepthRange kAll = {0, std::numeric_limits<float>::infinity()};
  WriteMaps(views.ref.camera,
            info.is_final ? problems_[problem].published : kAll,
            filter ? &keep : nullptr,
            files,
            &stamp,
            result);
  if (plan_.WritesGraph(stage, image)) {
    ConsistencyGraph graph = {map.width, map.height, {}};
    const Map depth = ReadMap(files.depth);
    for (size_t i = 0; i < consistent.size(); ++i) {
      if (consistent[i] == 0 || depth.data[i] == 0) continue;
      graph.data.push_back(static_cast<int32_t>(i % map.width));
      graph.data.push_back(static_cast<int32_t>(i / map.width));
      graph.data.push_back(__builtin_popcount(consistent[i]));
      for (size_t j = 0; j < src_images_.size(); ++j) {
        if (consistent[i] >> j & 1) graph.data.push_back(src_images_[j]);
      }
    }
    stamp.files["graph"] = WriteConsistencyGraph(files.graph, graph);
  }
  if (options_.hpm.previews && info.is_final) {
    WritePreviews(workspace_.StereoPath() / "previews",
                  name,
                  {ReadMap(files.depth), ReadMap(files.normal)});
  }
  const bool is_complete = !misses_maps_ && plan_.HasSameImages(problem);
  stamp.fingerprint = is_complete
                          ? plan_.FingerprintOf(stage, problem)
                          : plan_.IncompleteFingerprintOf(stage, problem);
  stamp.statistics = ToJson(*result);
  lock_.ThrowIfLost();
  WriteStamp(workspace_.StatePath(), name, stage_name, stamp);
}

void StageRunner::WriteMaps(const Camera& camera,
                            const DepthRange& range,
                            const std::vector<bool>* keep,
                            const StageFiles& files,
                            Stamp* stamp,
                            StageResult* result) {
  const int width = map_.width, height = map_.height;
  MapWriter normal(files.normal, {width, height, 3});
  MapWriter depth(files.depth, {width, height, 1});
  const WrittenDepths written =
      WritePlanes(map_, camera, range, keep, &depth, &normal);
  // The disk may take both at once; their names appear in this order.
  tbb::parallel_invoke([&] { normal.Flush(); }, [&] { depth.Flush(); });
  stamp->files["normal"] = normal.Commit();
  lock_.ThrowIfLost();
  stamp->files["depth"] = depth.Commit();
  const auto size = static_cast<double>(map_.planes.size());
  const size_t num_without = map_.planes.size() - written.num_valid;
  result->valid_pixel_share = 1.0 - static_cast<double>(num_without) / size;
  if (written.num_dropped > 0) {
    result->losses[FilterCriterion::kRange] =
        static_cast<double>(written.num_dropped) / size;
  }
}

}  // namespace hpm
