#include "src/engine/estimator.h"

#include "src/engine/phase_timer.h"
#include "src/prior/build_prior.h"

namespace hpm {

HypothesisMap EstimatePhotometric(Backend* backend,
                                  const ViewSet& views,
                                  const Schedule& schedule,
                                  const MethodParams& params,
                                  const RunControl& control,
                                  PhaseTimes* times) {
  HypothesisMap map(views.ref.camera.width, views.ref.camera.height);
  {
    PhaseTimer timer(times, "prepare");
    backend->SetViews(views, params);
  }
  const double num_passes = static_cast<double>(schedule.photometric.size());
  for (size_t i = 0; i < schedule.photometric.size(); ++i) {
    const Pass& pass = schedule.photometric[i];
    RunControl pass_control = control;
    pass_control.progress = [&](double fraction) {
      if (control.progress)
        control.progress((static_cast<double>(i) + fraction) / num_passes);
    };
    if (pass.kind == PassKind::kPrior) {
      PhaseTimer timer(times, "build prior");
      map.priors = BuildPrior(map,
                              views.ref.camera,
                              *views.ref.image,
                              pass.level,
                              {views.depth_min, views.depth_max});
    } else {
      map.priors.clear();
    }
    PhaseTimer timer(times, pass.kind == PassKind::kPrior ? "prior" : "basic");
    backend->Run(pass, schedule.pattern, &map, pass_control);
  }
  map.priors = {};
  return map;
}

void RefineGeometric(Backend* backend,
                     const ViewSet& views,
                     const Schedule& schedule,
                     const Pass& pass,
                     const MethodParams& params,
                     const RunControl& control,
                     HypothesisMap* map,
                     PhaseTimes* times) {
  {
    PhaseTimer timer(times, "prepare");
    backend->SetViews(views, params);
  }
  PhaseTimer timer(times, "geometric");
  backend->Run(pass, schedule.pattern, map, control);
}

}  // namespace hpm
