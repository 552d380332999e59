// Which images help a reference image whose tracks do not tell: those that see
// the same part of the world under a good angle.
#pragma once

#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/seen_points.h"

#include <vector>

namespace hpm {

class OverlapSelector {
 public:
  // Keeps a reference.
  explicit OverlapSelector(const SeenPoints& seen);

  // Best first, of `candidates`, which ascend: the images into which most of
  // the reference's points project, weighted by their angles; three quarters of
  // the points as in SourceSelector::Select() for min_angle (degrees). The
  // points are the sparse points that the reference sees, or, where these are
  // too few, its field of view within `range`.
  std::vector<int> Select(int ref_image,
                          const DepthRange& range,
                          double min_angle,
                          const std::vector<int>& candidates) const;

 private:
  std::vector<Eigen::Vector3d> PointsOf(int image,
                                        const DepthRange& range) const;

  const SeenPoints& seen_;
  const ModelViews& views_;
};

}  // namespace hpm
