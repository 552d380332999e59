// Depth ranges of images of which tracks tell too little.
#pragma once

#include "colmap_plugin/workspace/depth_range.h"
#include "colmap_plugin/workspace/seen_points.h"

#include <map>
#include <mutex>
#include <optional>
#include <vector>

namespace hpm {

// May be asked by several threads at once.
class RangeEstimator {
 public:
  // Keeps a reference.
  explicit RangeEstimator(const SeenPoints& seen);

  // From the sparse points that project into the image; where these are too
  // few, also from what images of known range may see in front of it; where
  // that is too little, also from the depths at which the other views help.
  // tracked: depths of the points whose tracks hold the image: they count in
  // any case, and whoever writes a few by hand means them. known: ranges of all
  // images, where tracks suffice.
  std::optional<DepthRange> Estimate(
      int image,
      const std::vector<float>& tracked,
      const std::vector<std::optional<DepthRange>>& known) const;

 private:
  std::vector<float> SeenDepths(int image) const;
  // Nothing if it sees too few.
  std::optional<DepthRange> RangeOfSeenPoints(int image) const;
  std::vector<float> DepthsOfNeighbours(
      int image, const std::vector<std::optional<DepthRange>>& known) const;
  std::optional<DepthRange> RangeOfParallax(int image) const;
  // How well the others would see what the image sees at this depth.
  double Support(int image, const std::vector<int>& others, double depth) const;
  std::vector<int> SomeOthers(int image) const;

  const SeenPoints& seen_;
  const ModelViews& views_;
  // Of images that were asked for as neighbours.
  mutable std::mutex mutex_;
  mutable std::map<int, std::optional<DepthRange>> seen_ranges_;
};

}  // namespace hpm
