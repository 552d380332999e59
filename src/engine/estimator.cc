#include "src/engine/estimator.h"

#include "src/engine/mine_regions.h"
#include "src/engine/phase_timer.h"
#include "src/prior/build_prior.h"

namespace hpm {
namespace {

const char* PhaseName(PassKind kind) {
  switch (kind) {
    case PassKind::kBasic:
      return "basic";
    case PassKind::kPrior:
      return "prior";
    case PassKind::kGeometric:
      break;
  }
  return "geometric";
}

// ACMM's detail restoration: what came up from the coarser level stays unless
// the finer level matches clearly better (specification 12.3).
void KeepUnlessClearlyBetter(const HypothesisMap& carried, HypothesisMap* map) {
  constexpr float kClearly = 0.1f;
  for (size_t i = 0; i < map->planes.size(); ++i) {
    if (map->costs[i] < carried.costs[i] - kClearly) continue;
    map->planes[i] = carried.planes[i];
    map->costs[i] = carried.costs[i];
    map->masks[i] = carried.masks[i];
  }
}

}  // namespace

void RunStage(Backend* backend,
              const ViewSet& views,
              const Schedule& schedule,
              const StageSpec& stage,
              const MethodParams& params,
              const RunControl& control,
              HypothesisMap* map,
              PhaseTimes* times) {
  if (stage.passes.empty()) return;
  {
    PhaseTimer timer(times, "prepare");
    backend->SetViews(views, params);
  }
  HypothesisMap carried;
  if (stage.from_coarser) {
    PhaseTimer timer(times, "basic");
    const Pass cost_only = {PassKind::kBasic,
                            StartFrom::kCurrent,
                            0,
                            stage.passes.front().id,
                            0,
                            false};
    backend->Run(cost_only, schedule.pattern, map, {control.cancel, nullptr});
    carried = *map;
  }
  const double num_passes = static_cast<double>(stage.passes.size());
  for (size_t i = 0; i < stage.passes.size(); ++i) {
    const Pass& pass = stage.passes[i];
    RunControl pass_control = control;
    pass_control.continues = i > 0 && !stage.from_coarser;
    pass_control.progress = [&](double fraction) {
      if (control.progress) {
        control.progress((static_cast<double>(i) + fraction) / num_passes);
      }
    };
    if (pass.kind == PassKind::kPrior) {
      PhaseTimer timer(times, "build prior");
      const PriorRange range = {views.depth_min, views.depth_max};
      if (backend->UpsamplesPriors()) {
        map->priors =
            BuildLevelPrior(*map, views.ref.camera, pass.level, range);
        map->prior_level = pass.level;
      } else {
        map->priors = BuildPrior(
            *map, views.ref.camera, *views.ref.image, pass.level, range);
      }
    }
    if (pass.regions != RegionPriors::kNone) {
      PhaseTimer timer(times, "build prior");
      map->priors = MineRegions(views, params, *map, pass.id);
    }
    {
      PhaseTimer timer(times, PhaseName(pass.kind));
      backend->Run(pass, schedule.pattern, map, pass_control);
    }
    if (stage.from_coarser && pass.kind == PassKind::kBasic) {
      KeepUnlessClearlyBetter(carried, map);
    }
    map->priors = std::vector<Plane>();  // gives the memory back, {} would not
    map->prior_level = 0;
  }
}

}  // namespace hpm
