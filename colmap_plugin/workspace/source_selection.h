// Which images help a reference image: those that share sparse points with it
// under a large enough angle (COLMAP's "__auto__").
#pragma once

#include "colmap_plugin/workspace/track_index.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

#include <cstdint>
#include <functional>
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

  // Candidates() of each of ref_images. Where that is most of the images, each
  // pair is counted once and told to both: planning large models is counting.
  // on_image: after each of ref_images, from any thread; may throw.
  std::vector<std::vector<SourceCandidate>> CandidatesOf(
      const std::vector<int>& ref_images,
      double min_angle,
      const CancelToken& cancel = {},
      const std::function<void()>& on_image = [] {}) const;

  // Whether the image shares a track with another, usable image at so many
  // points.
  bool SharesPoints(int image, size_t num_points) const;

 private:
  // Of one reference, by image: all zero between two calls, so that a call
  // costs what the reference sees, however many images there are.
  using Scratch = std::vector<SourceCandidate>;

  enum class Others { kAll, kLater };

  // The candidates of a reference among the others, in no order.
  std::vector<SourceCandidate> Count(int ref_image,
                                     Others others,
                                     double min_angle,
                                     const CancelToken& cancel) const;

  const Workspace& workspace_;
  const TrackIndex& tracks_;
  mutable tbb::enumerable_thread_specific<Scratch> scratch_;
};

// The first max_num candidates (negative: all) that see the points they share
// with the reference under at least the angle they were counted for: the 75th
// percentile of the triangulation angles, by nearest rank, as COLMAP 3.8:
// element round(0.75 (n - 1)) of the n ascending angles.
std::vector<int> SelectWideEnough(
    const std::vector<SourceCandidate>& candidates, int max_num);

}  // namespace hpm
