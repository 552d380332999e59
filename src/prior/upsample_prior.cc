#include "src/prior/upsample_prior.h"

#include "src/core/upsample_plane.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

// UpsampleSpatialWeight() of all distances there are: pixels lie at odd
// multiples of half a pixel from the taps, and the nearest tap is less than one
// level pixel away.
class SpatialWeights {
 public:
  explicit SpatialWeights(int level)
      : halves_(2 << level),
        most_((kUpsampleRadius + 1) * halves_),
        side_(2 * most_ + 1),
        weights_(static_cast<size_t>(side_) * side_) {
    for (int y = 0; y < side_; ++y) {
      for (int x = 0; x < side_; ++x) {
        weights_[static_cast<size_t>(y) * side_ + x] = UpsampleSpatialWeight(
            static_cast<float>(x - most_) / static_cast<float>(halves_),
            static_cast<float>(y - most_) / static_cast<float>(halves_));
      }
    }
  }

  // Distances in level pixels.
  float operator()(float dx, float dy) const {
    const auto halves = static_cast<float>(halves_);
    const int x = static_cast<int>(dx * halves) + most_;
    const int y = static_cast<int>(dy * halves) + most_;
    return weights_[static_cast<size_t>(y) * side_ + x];
  }

 private:
  int halves_;  // half pixels per level pixel
  int most_;    // half pixels
  int side_;
  std::vector<float> weights_;
};

}  // namespace

void UpsamplePrior(const std::vector<Plane>& planes,
                   int level,
                   const Camera& camera,
                   const GrayImage& guide,
                   const PriorRange& range,
                   std::vector<Plane>* result) {
  const SpatialWeights spatial_weight(level);
  float color_weight[256];
  for (int d = 0; d < 256; ++d) color_weight[d] = UpsampleColorWeight(d);
  result->resize(static_cast<size_t>(camera.width) * camera.height);
  tbb::parallel_for(
      tbb::blocked_range<int>(0, camera.height), [&](const auto& rows) {
        for (int row = rows.begin(); row < rows.end(); ++row) {
          for (int col = 0; col < camera.width; ++col) {
            (*result)[static_cast<size_t>(row) * camera.width + col] =
                UpsamplePlaneAt(
                    planes.data(),
                    level,
                    camera,
                    [&](int c, int r) { return guide.at(c, r); },
                    spatial_weight,
                    [&](int d) { return color_weight[d]; },
                    range.depth_min,
                    range.depth_max,
                    col,
                    row);
          }
        }
      });
}

}  // namespace hpm
