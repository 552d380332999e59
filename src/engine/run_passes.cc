#include "src/engine/run_passes.h"

#include "src/base/large_vectors.h"
#include "src/engine/local_planes.h"
#include "src/engine/mine_regions.h"
#include "src/engine/offer_triangles.h"
#include "src/engine/phase_timer.h"
#include "src/engine/settled_pixels.h"
#include "src/engine/view_propagation.h"
#include "src/engine/visit_params.h"
#include "src/engine/work_estimate.h"
#include "src/prior/build_prior.h"
#include "src/prior/weak_regions.h"

#include <utility>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr size_t kPixelsPerTask = 1 << 14;
constexpr float kFitTolerance = 0.5f;  // pixels, see FitLocalPlanes()

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

constexpr float kClearly = 0.1f;  // of costs

// Merges what a level found itself with what came up from the coarser one,
// pixel by pixel. A coarse level knows plain surfaces, a fine one detail: where
// the fine level searched, it must match clearly worse to lose; elsewhere, by
// `margin` better to win.
void MergeLevels(const HypothesisMap& carried,
                 const std::vector<bool>& searched,
                 float margin,
                 HypothesisMap* map) {
  tbb::parallel_for(
      tbb::blocked_range<size_t>(0, map->planes.size(), kPixelsPerTask),
      [&](const auto& pixels) {
        for (size_t i = pixels.begin(); i < pixels.end(); ++i) {
          const float may_lose = searched[i] ? kClearly : -margin;
          if (map->costs[i] < carried.costs[i] + may_lose) continue;
          map->planes[i] = carried.planes[i];
          map->costs[i] = carried.costs[i];
          map->masks[i] = carried.masks[i];
        }
      });
  map->Touch();
}

// What a level must match better to win where it did not search. In ACMM's
// detail restoration, clearly. Else by anything: what came up is less exact on
// a wall, and in a sky it is the same in all views.
float MarginOf(const Pass& search) {
  return search.start == StartFrom::kMissing ? 0 : kClearly;
}

WeakRegions RegionsOf(const ViewSet& views, const MethodParams& params) {
  return FindWeakRegions(
      *views.ref.image, params.weak_gradient, params.region_min_share);
}

// Forgets the hypotheses of textured pixels; returns which.
std::vector<bool> ForgetTextured(const WeakRegions& regions,
                                 HypothesisMap* map) {
  std::vector<bool> textured(map->planes.size(), false);
  regions.ForEachBand([&](const Rows& rows) {
    const size_t end = static_cast<size_t>(rows.end) * regions.width;
    for (size_t i = static_cast<size_t>(rows.begin) * regions.width; i < end;
         ++i) {
      if (regions.label[i] > 0) continue;
      textured[i] = true;
      map->planes[i].distance = 0;
    }
  });
  map->Touch();
  return textured;
}

// What a pass takes from the maps of the sources before it starts.
void AskOtherViews(Backend* backend,
                   const ViewSet& views,
                   const Pass& pass,
                   const MethodParams& params,
                   const CancelToken* cancel,
                   HypothesisMap* map,
                   PhaseTimes* times) {
  const auto score = [&](const std::vector<PixelPlane>& planes) {
    return backend->Score(planes, {cancel, nullptr});
  };
  WeakRegions regions;
  {
    PhaseTimer timer(times, "find regions");
    regions = RegionsOf(views, params);
  }
  if (pass.propagate_views) {
    PhaseTimer timer(times, "propagate views");
    PropagateViews(views, regions, score, cancel, map);
  }
  if (pass.regions != RegionPriors::kNone) {
    PhaseTimer timer(times, "build prior");
    MinedRegions mined =
        MineRegions(views, regions, params, *map, pass.id, score);
    map->priors = std::move(mined.priors);
    map->unexplained = std::move(mined.unexplained);
    SettleOnPriors(views, regions, params, map);
    if (pass.triangles)
      OfferTriangles(views, regions, mined.agreement, score, map);
  }
}

}  // namespace

void RunPasses(Backend* backend,
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
  std::vector<bool> searched;
  if (stage.from_coarser) {
    PhaseTimer timer(times, "basic");
    Pass judge = {PassKind::kBasic,
                  StartFrom::kCurrent,
                  0,
                  stage.passes.front().id,
                  0,
                  false};
    judge.ask_all_views = stage.passes.front().ask_all_views;
    backend->Run(judge, schedule.pattern, map, {control.cancel, nullptr});
    carried.planes = Copied(map->planes);
    carried.costs = Copied(map->costs);
    carried.masks = Copied(map->masks);
    searched.assign(map->planes.size(), false);
    if (stage.passes.front().start == StartFrom::kMissing) {
      const WeakRegions regions = RegionsOf(views, params);
      map->visits = VisitsBelowCoarserLevel(views, regions, params, *map);
      searched = ForgetTextured(regions, map);
    }
  }
  if (stage.passes.front().rest_plain) {
    PhaseTimer timer(times, "find regions");
    map->visits = VisitsByTexture(RegionsOf(views, params));
  }
  const double work = StageWork(stage);
  double work_done = JudgeWork(stage);
  for (const Pass& pass : stage.passes) {
    work_done += PriorWork(pass);
    RunControl pass_control = control;
    pass_control.progress = [&](double fraction) {
      if (control.progress)
        control.progress((work_done + fraction * PassWork(pass)) / work);
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
    if (pass.propagate_views || pass.regions != RegionPriors::kNone)
      AskOtherViews(backend, views, pass, params, control.cancel, map, times);
    {
      PhaseTimer timer(times, PhaseName(pass.kind));
      backend->Run(pass, schedule.pattern, map, pass_control);
    }
    work_done += PassWork(pass);
    if (stage.from_coarser && pass.kind == PassKind::kBasic) {
      MergeLevels(carried, searched, MarginOf(pass), map);
      carried = {};  // before priors are made
    }
    if (pass.fit_planes) {
      PhaseTimer timer(times, "fit planes");
      FitLocalPlanes(views.ref.camera,
                     *views.ref.image,
                     kFitTolerance / Parallax(views),
                     {views.depth_min, views.depth_max},
                     map);
    }
    // Gives the memory back, {} would not.
    map->priors = std::vector<Plane>();
    map->visits = std::vector<uint8_t>();
    map->prior_level = 0;
  }
}

}  // namespace hpm
