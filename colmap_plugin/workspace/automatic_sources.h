// The sources of a reference where the user leaves the choice to us.
#pragma once

#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/overlap_selection.h"
#include "colmap_plugin/workspace/source_selection.h"

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace hpm {

// By the points that images share, as COLMAP does; behind them, where tracks
// tell too little, those that look at the same place. Images without a picture
// are among them: who needs pictures leaves them out.
// May be asked by several threads at once.
class AutomaticSources {
 public:
  // Keeps references to all.
  AutomaticSources(const Workspace& workspace,
                   const TrackIndex& tracks,
                   const SeenPoints& seen,
                   const CancelToken& cancel);

  // Of each reference whom it shares points with, counted for min_angle
  // (degrees): what Best() and All() choose from. on_image: as in
  // SourceSelector::CandidatesOf().
  std::vector<std::vector<SourceCandidate>> Sharing(
      const std::vector<int>& ref_images,
      double min_angle,
      const std::function<void()>& on_image) const;

  // Best first. All that share points under at least min_angle (degrees), and
  // of others so many that max_num have a picture. `range`: the reference's
  // depths; without, only shared points count.
  std::vector<int> Best(int ref_image,
                        const std::vector<SourceCandidate>& sharing,
                        const std::optional<DepthRange>& range,
                        double min_angle,
                        size_t max_num) const;

  // All usable images but the reference; those that see the same come first.
  std::vector<int> All(int ref_image,
                       const std::vector<SourceCandidate>& sharing,
                       const std::optional<DepthRange>& range) const;

  bool SharesPoints(int image) const;

 private:
  void AddOverlapping(int ref,
                      const std::optional<DepthRange>& range,
                      double min_angle,
                      const std::vector<int>& candidates,
                      size_t max_num,
                      std::vector<int>* sources) const;

  const Workspace& workspace_;
  const SourceSelector selector_;
  const OverlapSelector overlap_;
  const CancelToken& cancel_;
  std::vector<int> all_;
  // Images that share too few points with others for a choice of sources.
  std::vector<bool> is_badly_tracked_;
  std::vector<int> badly_tracked_;
};

// Leaves out images without a picture, and what exceeds max_num.
void TakeThoseWithPictures(const Workspace& workspace,
                           size_t max_num,
                           std::vector<int>* images);

}  // namespace hpm
