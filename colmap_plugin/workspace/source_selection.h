// Which images help a reference image: those that share sparse points with it
// under a large enough angle (COLMAP's "__auto__").
#pragma once

#include "colmap_plugin/workspace/workspace.h"

#include <cstdint>
#include <vector>

namespace hpm {

struct SourceCandidate {
  int image = -1;
  uint64_t num_shared =
      0;  // pairs of track elements (reference, image) over all points
  float angle =
      0;  // radians, 75th percentile of the triangulation angles of these pairs
};

class SourceSelector {
 public:
  // One pass over the points. Keeps a reference to `workspace`.
  explicit SourceSelector(const Workspace& workspace);

  // Every usable image that shares a point with ref_image, most shared points
  // first, then by image index.
  std::vector<SourceCandidate> Candidates(int ref_image) const;

  // Points of which the image shares a track with another, usable image.
  size_t NumSharedPoints(int ref_image) const;

  // The first max_num candidates (negative: all) with an angle of at least
  // min_angle degrees.
  std::vector<int> Select(int ref_image, double min_angle, int max_num) const;

 private:
  const Workspace& workspace_;
  // Points of image i, each once: points_[begin_[i] .. begin_[i + 1]).
  std::vector<size_t> begin_;
  std::vector<uint32_t> points_;
};

}  // namespace hpm
