#include "src/prior/upsample_prior.h"

#include "src/core/upsample_plane.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {

std::vector<Plane> UpsamplePrior(const std::vector<Plane>& planes,
                                 int level,
                                 const Camera& camera,
                                 const GrayImage& guide,
                                 const PriorRange& range) {
  float color_weight[256];
  for (int d = 0; d < 256; ++d) color_weight[d] = UpsampleColorWeight(d);
  std::vector<Plane> result(static_cast<size_t>(camera.width) * camera.height);
  tbb::parallel_for(
      tbb::blocked_range<int>(0, camera.height), [&](const auto& rows) {
        for (int row = rows.begin(); row < rows.end(); ++row) {
          for (int col = 0; col < camera.width; ++col) {
            result[static_cast<size_t>(row) * camera.width + col] =
                UpsamplePlaneAt(
                    planes.data(),
                    level,
                    camera,
                    [&](int c, int r) { return guide.at(c, r); },
                    [&](int d) { return color_weight[d]; },
                    range.depth_min,
                    range.depth_max,
                    col,
                    row);
          }
        }
      });
  return result;
}

}  // namespace hpm
