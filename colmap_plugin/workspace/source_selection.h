// Which images help a reference image: those that share sparse points with it
// under a large enough angle (COLMAP's "__auto__").
#pragma once

#include "colmap_plugin/workspace/track_index.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

#include <cstdint>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

namespace hpm {

struct SourceCandidate {
  int image = -1;
  uint64_t num_shared =
      0;  // pairs of track elements (reference, image) over all points
  // Of these, pairs that see their point under less than the angle asked for.
  uint64_t num_narrow = 0;
};

// May be asked by several threads at once.
class SourceSelector {
 public:
  // Keeps references to both.
  SourceSelector(const Workspace& workspace, const TrackIndex& tracks);

  // Every usable image that shares a point with ref_image, most shared points
  // first, then by image index. min_angle: degrees. Throws Error(kInterrupted).
  std::vector<SourceCandidate> Candidates(int ref_image,
                                          double min_angle,
                                          const CancelToken& cancel = {}) const;

  // Whether the image shares a track with another, usable image at so many
  // points.
  bool SharesPoints(int image, size_t num_points) const;

  // The first max_num candidates (negative: all) that see the points they share
  // with the reference under at least min_angle degrees: the 75th percentile of
  // the triangulation angles, by nearest rank, as COLMAP 3.8: element
  // round(0.75 (n - 1)) of the n ascending angles.
  std::vector<int> Select(int ref_image,
                          double min_angle,
                          int max_num,
                          const CancelToken& cancel = {}) const;

 private:
  // Of one reference, by image: all zero between two calls, so that a call
  // costs what the reference sees, however many images there are.
  using Scratch = std::vector<SourceCandidate>;

  const Workspace& workspace_;
  const TrackIndex& tracks_;
  mutable tbb::enumerable_thread_specific<Scratch> scratch_;
};

}  // namespace hpm
