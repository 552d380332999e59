// What planning asks of the sparse model: which images help which, and depth
// ranges. Read once per run; images that turn out to be damaged change nothing
// about it.
#pragma once

#include "colmap_plugin/workspace/automatic_sources.h"
#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/track_index.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

namespace hpm {

class ModelOverview {
 public:
  // A depth range that the user gives, or negative; see DepthRanges. Keeps
  // references to workspace and cancel. Throws as DepthRanges does.
  ModelOverview(const Workspace& workspace,
                double depth_min,
                double depth_max,
                const CancelToken& cancel);

  // Both may be asked by several threads at once.
  const AutomaticSources& automatic() const { return automatic_; }
  const DepthRanges& ranges() const { return ranges_; }

 private:
  const TrackIndex tracks_;
  const DepthRanges ranges_;
  const AutomaticSources automatic_;
};

}  // namespace hpm
