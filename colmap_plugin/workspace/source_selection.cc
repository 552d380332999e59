#include "colmap_plugin/workspace/source_selection.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <utility>

#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr size_t kPointsBetweenLooks = 4096;

// Whether the angle a between two rays, which enters as min(a, pi - a), is
// below a bound. Its cosine |cos a| falls with the angle, so no arc cosine is
// needed, and, where rounding cannot matter, no root.
class AngleBound {
 public:
  explicit AngleBound(double min_angle)
      : max_cos_(LargestCosOf(static_cast<float>(min_angle * kPi / 180))),
        squared_max_cos_(max_cos_ * max_cos_) {}

  bool IsBelow(const Eigen::Vector3d& ray1,
               double squared_length1,
               const Eigen::Vector3d& ray2) const {
    constexpr double kSure = 1e-9;
    constexpr double kTiny = 1e-280;
    const double squared_lengths = squared_length1 * ray2.squaredNorm();
    const double dot = ray1.dot(ray2);
    const double difference = dot * dot - squared_max_cos_ * squared_lengths;
    if (max_cos_ >= 0 && squared_lengths > kTiny &&
        std::abs(difference) > kSure * squared_lengths) {
      return difference > 0;
    }
    const double lengths = std::sqrt(squared_lengths);
    const double abs_cos =
        lengths > 0 ? std::min(1.0, std::abs(dot) / lengths) : 1;
    return abs_cos > max_cos_;
  }

 private:
  // The largest number in 0 ... 1 whose arc cosine, as a float, is no less;
  // -1 if there is none. Positive doubles are in the order of their bits.
  static double LargestCosOf(float angle) {
    const auto is_enough = [angle](uint64_t bits) {
      return static_cast<float>(std::acos(FromBits(bits))) >= angle;
    };
    uint64_t enough = 0, too_much = BitsOf(1.0) + 1;
    if (!is_enough(enough)) return -1;
    while (enough + 1 < too_much) {
      const uint64_t middle = enough + (too_much - enough) / 2;
      (is_enough(middle) ? enough : too_much) = middle;
    }
    return FromBits(enough);
  }

  static double FromBits(uint64_t bits) {
    double value;
    std::memcpy(&value, &bits, sizeof(value));
    return value;
  }

  static uint64_t BitsOf(double value) {
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof(bits));
    return bits;
  }

  double max_cos_;
  double squared_max_cos_;
};

bool IsWideEnough(const SourceCandidate& candidate) {
  const auto rank = static_cast<uint64_t>(
      std::round(0.75 * static_cast<double>(candidate.num_shared - 1)));
  return candidate.num_narrow <= rank;
}

void SortBest(std::vector<SourceCandidate>* candidates) {
  std::sort(candidates->begin(),
            candidates->end(),
            [](const SourceCandidate& a, const SourceCandidate& b) {
              return a.num_shared != b.num_shared ? a.num_shared > b.num_shared
                                                  : a.image < b.image;
            });
}

// As COLMAP, which holds points as floats.
bool IsFinite(const SparsePoint& point) {
  return point.xyz.cast<float>().allFinite();
}

}  // namespace

SourceSelector::SourceSelector(const Workspace& workspace,
                               const TrackIndex& tracks)
    : workspace_(workspace),
      tracks_(tracks),
      scratch_(Scratch(static_cast<size_t>(workspace.num_images()))) {}

std::vector<SourceCandidate> SourceSelector::Candidates(
    int ref_image, double min_angle, const CancelToken& cancel) const {
  std::vector<SourceCandidate> candidates =
      Count(ref_image, Others::kAll, min_angle, cancel);
  SortBest(&candidates);
  return candidates;
}

std::vector<std::vector<SourceCandidate>> SourceSelector::CandidatesOf(
    const std::vector<int>& ref_images,
    double min_angle,
    const CancelToken& cancel,
    const std::function<void()>& on_image) const {
  const auto num_images = static_cast<size_t>(workspace_.num_images());
  std::vector<std::vector<SourceCandidate>> of_refs(ref_images.size());
  if (2 * ref_images.size() <= num_images) {
    tbb::parallel_for(size_t{0}, ref_images.size(), [&](size_t i) {
      of_refs[i] = Candidates(ref_images[i], min_angle, cancel);
      on_image();
    });
    return of_refs;
  }
  std::vector<char> is_asked(num_images, 0);
  for (const int ref : ref_images) is_asked[static_cast<size_t>(ref)] = 1;
  std::vector<std::vector<SourceCandidate>> of_all(num_images);
  tbb::parallel_for(size_t{0}, num_images, [&](size_t i) {
    of_all[i] = Count(static_cast<int>(i), Others::kLater, min_angle, cancel);
    if (is_asked[i]) on_image();
  });
  // From behind, so that of_all[i] still holds later images alone.
  for (size_t i = num_images; i-- > 0;) {
    for (const SourceCandidate& pair : of_all[i]) {
      SourceCandidate mirrored = pair;
      mirrored.image = static_cast<int>(i);
      of_all[static_cast<size_t>(pair.image)].push_back(mirrored);
    }
  }
  tbb::parallel_for(size_t{0}, ref_images.size(), [&](size_t i) {
    of_refs[i] = std::move(of_all[static_cast<size_t>(ref_images[i])]);
    SortBest(&of_refs[i]);
  });
  return of_refs;
}

std::vector<SourceCandidate> SourceSelector::Count(
    int ref_image,
    Others others,
    double min_angle,
    const CancelToken& cancel) const {
  std::vector<SourceCandidate> candidates;
  if (!workspace_.usable(ref_image)) return candidates;
  const SparsePoints& points = workspace_.model().points;
  const AngleBound bound(min_angle);
  const Eigen::Vector3d ref_center = workspace_.Center(ref_image);
  Scratch& shared = scratch_.local();
  std::vector<int> images;
  size_t num_points = 0;
  const auto visit = [&](size_t i, uint64_t count) {
    if (++num_points % kPointsBetweenLooks == 0 && cancel.cancelled())
      return false;
    const SparsePoint point = points[i];
    if (!IsFinite(point)) return true;
    const Eigen::Vector3d ref_ray = ref_center - point.xyz;
    const double squared_length = ref_ray.squaredNorm();
    // Tracks ascend, so later images come first from behind.
    for (const int* at = point.track.end(); at != point.track.begin();) {
      const int image = *--at;
      if (image < ref_image && others == Others::kLater) break;
      if (image == ref_image) continue;
      SourceCandidate& candidate = shared[static_cast<size_t>(image)];
      if (candidate.num_shared == 0) images.push_back(image);
      candidate.num_shared += count;
      const Eigen::Vector3d ray = workspace_.Center(image) - point.xyz;
      if (bound.IsBelow(ref_ray, squared_length, ray))
        candidate.num_narrow += count;
    }
    return true;
  };
  tracks_.ForEachPoint(ref_image, TrackIndex::Reads::kTracks, visit);
  for (const int image : images) {
    SourceCandidate& candidate = shared[static_cast<size_t>(image)];
    candidate.image = image;
    if (workspace_.usable(image)) candidates.push_back(candidate);
    candidate = {};
  }
  cancel.ThrowIfCancelled();
  return candidates;
}

bool SourceSelector::SharesPoints(int image, size_t num_points) const {
  const SparsePoints& points = workspace_.model().points;
  size_t num_shared = 0;
  const auto visit = [&](size_t i, size_t) {
    if (num_shared == num_points) return false;
    const SparsePoint point = points[i];
    num_shared +=
        IsFinite(point) &&
        std::any_of(point.track.begin(), point.track.end(), [&](int other) {
          return other != image && workspace_.usable(other);
        });
    return true;
  };
  tracks_.ForEachPoint(image, TrackIndex::Reads::kTracks, visit);
  return num_shared >= num_points;
}

std::vector<int> SelectWideEnough(
    const std::vector<SourceCandidate>& candidates, int max_num) {
  std::vector<int> images;
  for (const SourceCandidate& candidate : candidates) {
    if (max_num >= 0 && images.size() >= static_cast<size_t>(max_num)) break;
    if (IsWideEnough(candidate)) images.push_back(candidate.image);
  }
  return images;
}

}  // namespace hpm
