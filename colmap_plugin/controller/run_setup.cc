#include "colmap_plugin/controller/run_setup.h"

#include "colmap_plugin/workspace/overlap_order.h"
#include "colmap_plugin/workspace/source_problems.h"
#include "src/engine/method.h"
#include "src/engine/schedule.h"

#include <algorithm>
#include <utility>

namespace hpm {

void CompleteProblems(const Workspace& workspace,
                      const ModelOverview& overview,
                      const ControllerOptions& options,
                      const LogSink& log,
                      const CancelToken& cancel,
                      std::vector<StereoProblem>* problems) {
  OrderByOverlap(problems);
  if (!options.patch_match.geom_consistency) return;
  const size_t num_references = problems->size();
  for (StereoProblem& problem : SourceProblems(
           workspace, overview, *problems, options.problems, log, cancel))
    problems->push_back(std::move(problem));
  OrderByOverlap(problems, num_references);
}

void SetLevels(const Workspace& workspace, ControllerOptions* options) {
  if (options->hpm.num_levels > 0) return;
  int side = 1;
  for (int image = 0; image < workspace.num_images(); ++image) {
    if (!workspace.usable(image)) continue;
    const Camera& camera = workspace.camera(image);
    side = std::max({side, camera.width, camera.height});
  }
  options->hpm.num_levels =
      AutomaticLevels(FindMethod(options->hpm.method), side);
}

}  // namespace hpm
