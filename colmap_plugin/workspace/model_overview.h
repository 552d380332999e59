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

struct ProblemOptions;

class ModelOverview {
 public:
  // Of the options those of the depth range count. Keeps references to
  // workspace and cancel. Throws as DepthRanges and ReadGivenRanges do.
  ModelOverview(const Workspace& workspace,
                const ProblemOptions& options,
                const CancelToken& cancel);

  // All may be asked by several threads at once.
  const TrackIndex& tracks() const { return tracks_; }
  const AutomaticSources& automatic() const { return automatic_; }
  const DepthRanges& ranges() const { return ranges_; }

 private:
  const TrackIndex tracks_;
  const DepthRanges ranges_;
  const AutomaticSources automatic_;
};

}  // namespace hpm
