#include "src/engine/run_stage.h"

#include "src/engine/confidence.h"
#include "src/engine/needed_views.h"
#include "src/engine/phase_timer.h"
#include "src/engine/work_estimate.h"
#include "src/prior/upsample_prior.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

namespace hpm {
namespace {

View ViewOf(int image,
            const Camera& camera,
            const std::shared_ptr<const GrayImage>& picture) {
  if (picture->width != camera.width || picture->height != camera.height) {
    throw Error(ErrorCode::kUsage,
                fmt::format("image {}: the picture has {} x {} pixels, its "
                            "camera {} x {}",
                            image,
                            picture->width,
                            picture->height,
                            camera.width,
                            camera.height));
  }
  return {camera, picture, nullptr};
}

ViewSet MakeViews(const Problem& problem,
                  const StageSpec& stage,
                  ImageStore* images) {
  std::vector<ImageRequest> requests = {{problem.image, 0}};
  // A stage without passes matches nothing.
  const size_t num_srcs = stage.passes.empty() ? 0 : problem.sources.size();
  for (size_t j = 0; j < num_srcs; ++j) {
    const ProblemSource& source = problem.sources[j];
    requests.push_back({source.image, source.more_levels});
  }
  const auto pictures = images->Images(requests);
  ViewSet views;
  views.ref = ViewOf(problem.image,
                     LevelCamera(problem.camera, stage.level),
                     pictures.front());
  for (size_t j = 0; j < num_srcs; ++j) {
    const ProblemSource& source = problem.sources[j];
    views.srcs.push_back(
        ViewOf(source.image,
               LevelCamera(source.camera, stage.level + source.more_levels),
               pictures[j + 1]));
  }
  views.depth_min = problem.depth_min;
  views.depth_max = problem.depth_max;
  views.random_key = problem.random_key;
  return views;
}

// Returns whether all depth maps are there that should be.
bool AddDepths(const std::vector<SourceDepth>& depths, ViewSet* views) {
  bool is_complete = true;
  for (size_t j = 0; j < views->srcs.size(); ++j) {
    views->srcs[j].inverse_depth = depths[j].map;
    is_complete = is_complete && depths[j].is_complete;
  }
  return is_complete;
}

// The hypotheses the stage starts from: none, those of the stage before, or
// those of the coarser level upsampled. Returns whether they are complete.
bool StartMap(const StageSpec& spec,
              int stage,
              int problem,
              const ViewSet& views,
              MapStore* maps,
              HypothesisMap* map) {
  const Camera& camera = views.ref.camera;
  if (!spec.geometric && !spec.from_coarser) {
    map->Reset(camera.width, camera.height);
    return true;
  }
  map->ResetAllButPlanes(camera.width, camera.height);
  if (spec.geometric) return maps->ReadPlanes(stage - 1, problem, &map->planes);
  std::vector<Plane> coarse;
  const bool is_complete = maps->ReadPlanes(stage - 1, problem, &coarse);
  UpsamplePrior(coarse,
                1,
                camera,
                *views.ref.image,
                {views.depth_min, views.depth_max},
                &map->planes);
  return is_complete;
}

void Filter(const MapFilter& filter,
            bool geometric,
            Backend* backend,
            const RunControl& control,
            StageOutput* output) {
  PhaseTimer timer(&output->seconds, "filter");
  const ViewSet& views = output->views;
  const HypothesisMap& map = *output->map;
  output->filter = filter.params;
  output->filter.min_num_consistent = std::min(
      filter.params.min_num_consistent, static_cast<int>(views.srcs.size()));
  // The maps of all sources may have failed.
  output->filter_is_geometric =
      geometric &&
      std::any_of(views.srcs.begin(), views.srcs.end(), [](const View& src) {
        return src.inverse_depth != nullptr;
      });
  output->consistent = backend->ConsistentViews(
      map, output->filter, output->filter_is_geometric, control);
  const NeededViews needed(views,
                           map,
                           output->filter,
                           filter.min_agreement,
                           output->filter_is_geometric);
  if (filter.rates)
    output->confidence = Confidence(views, needed, map, output->consistent);
  if (!filter.drops) return;
  output->keep.resize(output->consistent.size());
  for (size_t i = 0; i < output->keep.size(); ++i) {
    const int num = __builtin_popcount(output->consistent[i]);
    output->keep[i] =
        num >= output->filter.min_num_consistent && num >= needed.At(i);
  }
}

// No stage keeps what was found where the image shows nothing.
void DropGaps(const GrayImage& image, std::vector<bool>* keep) {
  if (!image.has_gaps) return;
  keep->resize(image.data.size(), true);
  for (size_t i = 0; i < keep->size(); ++i) {
    if (image.IsGap(i)) (*keep)[i] = false;
  }
}

}  // namespace

void RunStage(const RunSpec& run,
              int stage,
              int problem,
              ImageStore* images,
              MapStore* maps,
              Worker* worker,
              const RunControl& control) {
  const StageSpec& spec = run.schedule.stages[stage];
  Backend* backend = worker->backend.get();
  ViewSet views;
  StageOutput output(views, &worker->map);
  {
    PhaseTimer timer(&output.seconds, "read");
    views = MakeViews(run.problems[problem], spec, images);
    if (spec.geometric) {
      output.is_complete =
          AddDepths(maps->ReadSourceDepths(stage - 1, problem), &views);
    }
    output.is_complete &=
        StartMap(spec, stage, problem, views, maps, &worker->map);
  }
  output.is_final = stage + 1 == static_cast<int>(run.schedule.stages.size());
  const double share_of_passes =
      output.is_final && run.filter
          ? StageWork(spec) / (StageWork(spec) + kFilterWork)
          : 1;
  const RunControl passes_control = {
      control.cancel, [&](double fraction) {
        if (control.progress) control.progress(share_of_passes * fraction);
      }};
  RunPasses(backend,
            views,
            run.schedule,
            spec,
            run.params,
            passes_control,
            &worker->map,
            &output.seconds);
  if (output.is_final && run.filter)
    Filter(*run.filter, spec.geometric, backend, control, &output);
  DropGaps(*views.ref.image, &output.keep);
  if (!spec.passes.empty()) {
    output.cost_evaluations_per_pixel =
        static_cast<double>(backend->num_cost_evaluations()) /
        static_cast<double>(worker->map.planes.size());
    output.device_seconds = backend->DeviceSeconds();
  }
  // Before the maps are made and the next problem's inputs are read.
  backend->ForgetViews();
  maps->Write(stage, problem, &output);
}

}  // namespace hpm
