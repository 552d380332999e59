#include "colmap_plugin/workspace/model_overview.h"

namespace hpm {

ModelOverview::ModelOverview(const Workspace& workspace,
                             double depth_min,
                             double depth_max,
                             const CancelToken& cancel)
    : tracks_(workspace, cancel),
      ranges_(workspace, tracks_, depth_min, depth_max, cancel),
      automatic_(workspace, tracks_, ranges_.seen(), cancel) {}

}  // namespace hpm
