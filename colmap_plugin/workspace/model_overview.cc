#include "colmap_plugin/workspace/model_overview.h"

#include "colmap_plugin/workspace/given_ranges.h"
#include "colmap_plugin/workspace/problem.h"

namespace hpm {

ModelOverview::ModelOverview(const Workspace& workspace,
                             const ProblemOptions& options,
                             const CancelToken& cancel)
    : tracks_(workspace, cancel),
      ranges_(workspace,
              tracks_,
              options.depth_min,
              options.depth_max,
              ReadGivenRanges(workspace, options.depth_ranges),
              cancel),
      automatic_(workspace, tracks_, ranges_.seen(), cancel) {}

}  // namespace hpm
