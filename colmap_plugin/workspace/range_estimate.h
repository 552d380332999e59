// Depth ranges of images of which tracks tell too little.
#pragma once

#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/seen_points.h"

#include <optional>
#include <vector>

namespace hpm {

class RangeEstimator {
 public:
  explicit RangeEstimator(const Workspace& workspace);

  // In this order: from the sparse points that project into the image; where
  // these are too few, also from what images of known range may see in front of
  // it; where nothing is known, from the depths at which the other views help.
  // tracked: depths of the points whose tracks hold the image, which count in
  // any case. known: ranges of all images, where tracks suffice.
  std::optional<DepthRange> Estimate(
      int image,
      const std::vector<float>& tracked,
      const std::vector<std::optional<DepthRange>>& known) const;

 private:
  std::vector<float> DepthsOfNeighbours(
      int image, const std::vector<std::optional<DepthRange>>& known) const;
  std::optional<DepthRange> RangeOfParallax(int image) const;
  // How well the others would see what the image sees at this depth.
  double Support(int image, const std::vector<int>& others, double depth) const;
  std::vector<int> SomeOthers(int image) const;

  const ModelViews views_;
  const SeenPoints seen_;
};

}  // namespace hpm
