// Depth range of each image: given by the user for all, or COLMAP's automatic
// one from the sparse points it sees, or, where it sees too few, an estimate
// (range_estimate.h). Depth is z in the camera frame, model units.
//
// A given range says what is wanted, not what the images show: a search that
// cannot find the surface outside finds a false one inside. So the search is
// wider than the given range, and what lies outside is dropped in the end.
#pragma once

#include "colmap_plugin/workspace/seen_points.h"
#include "colmap_plugin/workspace/track_index.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <vector>

namespace hpm {

struct DepthRange {
  float min = 0;
  float max = 0;
};

// So many depths tell a range. In ten scenes the range of 10 random tracked
// points holds 98 % of the tracked depths of its image, and 92 % in the worst
// twentieth of the draws; the range of 3 holds 90 % and 65 %.
constexpr size_t kEnoughPoints = 10;

// [0.75 P1, 1.25 P99]; nothing if there are none or they are no range.
std::optional<DepthRange> RangeOfDepths(std::vector<float> depths);

class RangeEstimator;

class DepthRanges {
 public:
  // Automatic if given_min or given_max is negative: [0.75 P1, 1.25 P99] of the
  // positive depths of the points whose track holds the image, by several
  // threads. For the images of `given_for` their ranges count as given.
  // Throws Error(kUsage) for NaN, min > max or a zero max,
  // Error(kInterrupted).
  DepthRanges(const Workspace& workspace,
              const TrackIndex& tracks,
              double given_min,
              double given_max,
              std::map<int, DepthRange> given_for = {},
              const CancelToken& cancel = {});
  ~DepthRanges();

  // What to search. Always 0 < min < max: a lower end of zero becomes 0.001 *
  // max, and equal ends are moved apart by the factors 0.75 and 1.25. A given
  // range grows to hold the automatic one, as far as kSearchedBeyond goes: it
  // is also the remedy for wrong points. Nothing if no range is given and the
  // image is unusable, or neither points nor other views tell its range. May be
  // asked by several threads at once.
  std::optional<DepthRange> ForImage(int image) const;

  // Whether ForImage() has to estimate.
  bool IsEstimated(int image) const {
    return GivenFor(image) == nullptr && too_few_.count(image) > 0;
  }

  // What to publish: the given range, else everything.
  DepthRange Published(int image) const {
    const DepthRange* given = GivenFor(image);
    return given != nullptr
               ? *given
               : DepthRange{0, std::numeric_limits<float>::infinity()};
  }

  // A factor, at both ends of a given range.
  static constexpr float kSearchedBeyond = 4;

  // What the estimates go by, for others that ask geometry instead of tracks.
  const SeenPoints& seen() const { return seen_; }

 private:
  void ReadTracks(const Workspace& workspace,
                  const TrackIndex& tracks,
                  const CancelToken& cancel);

  // Null if none is given.
  const DepthRange* GivenFor(int image) const {
    const auto found = given_for_.find(image);
    if (found != given_for_.end()) return &found->second;
    return given_ ? &*given_ : nullptr;
  }

  std::optional<DepthRange> given_;
  std::map<int, DepthRange> given_for_;
  // Of each image: from tracks, if they are enough.
  std::vector<std::optional<DepthRange>> automatic_;
  // Depths of the points of tracks, of images where they are not enough.
  std::map<int, std::vector<float>> too_few_;
  const SeenPoints seen_;
  const std::unique_ptr<const RangeEstimator> estimator_;
};

}  // namespace hpm
