// Which sparse points an image sees, judged by geometry, not by tracks: models
// of feed-forward networks and of some converters have none.
#pragma once

#include "colmap_plugin/workspace/model_views.h"

#include <vector>

namespace hpm {

class SeenPoints {
 public:
  // Of big models an even sample is taken.
  explicit SeenPoints(const Workspace& workspace);

  const ModelViews& views() const { return views_; }

  struct SeenPoint {
    Eigen::Vector3d xyz;
    double depth;
  };
  // Points that project into the image and are not hidden: far behind what
  // else lies in the same part of the image.
  std::vector<SeenPoint> ForImage(int image) const;

 private:
  const ModelViews views_;
  std::vector<Eigen::Vector3d> points_;
};

}  // namespace hpm
