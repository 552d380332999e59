#include "src/prior/upsample_prior.h"

#include <algorithm>
#include <cmath>

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

namespace hpm {
namespace {

constexpr float kSigmaSpatial = 0.5f;  // level pixels
constexpr float kSigmaColor = 25.5f;   // grey levels
constexpr int kRadius = 1;  // taps beyond weigh less than 1e-3 of the nearest

}  // namespace

std::vector<Plane> UpsamplePrior(const std::vector<Plane>& planes,
                                 int level,
                                 const Camera& camera,
                                 const GrayImage& guide,
                                 const PriorRange& range) {
  const Camera low = LevelCamera(camera, level);
  const int factor = 1 << level;
  const float scale = 1.0f / static_cast<float>(factor);
  float color_weight[256];
  for (int d = 0; d < 256; ++d) {
    color_weight[d] =
        std::exp(-static_cast<float>(d * d) / (2 * kSigmaColor * kSigmaColor));
  }
  std::vector<Plane> result(static_cast<size_t>(camera.width) * camera.height,
                            Plane{{0, 0, 0}, 0});
  tbb::parallel_for(
      tbb::blocked_range<int>(0, camera.height), [&](const auto& rows) {
        for (int row = rows.begin(); row < rows.end(); ++row) {
          for (int col = 0; col < camera.width; ++col) {
            const float x = (static_cast<float>(col) + 0.5f) * scale - 0.5f;
            const float y = (static_cast<float>(row) + 0.5f) * scale - 0.5f;
            const Vec3f ray =
                RayAt(camera, static_cast<float>(col), static_cast<float>(row));
            const int grey = guide.at(col, row);
            const int near_col = col / factor;
            const int near_row = row / factor;
            float weights = 0, inverse_depth = 0;
            Vec3f normal = {0, 0, 0};
            for (int r = std::max(near_row - kRadius, 0);
                 r <= std::min(near_row + kRadius, low.height - 1);
                 ++r) {
              for (int c = std::max(near_col - kRadius, 0);
                   c <= std::min(near_col + kRadius, low.width - 1);
                   ++c) {
                const Plane& plane =
                    planes[static_cast<size_t>(r) * low.width + c];
                if (!(plane.distance > 0)) continue;
                const float inv_z = -Dot(plane.normal, ray) / plane.distance;
                if (!(inv_z > 0)) continue;
                const int tap = guide.at(
                    std::min(c * factor + factor / 2, camera.width - 1),
                    std::min(r * factor + factor / 2, camera.height - 1));
                const float dx = x - static_cast<float>(c);
                const float dy = y - static_cast<float>(r);
                const float w = std::exp(-(dx * dx + dy * dy) /
                                         (2 * kSigmaSpatial * kSigmaSpatial)) *
                                color_weight[std::abs(grey - tap)];
                weights += w;
                inverse_depth += w * inv_z;
                normal = normal + w * plane.normal;
              }
            }
            if (!(weights > 0)) continue;
            const float z = weights / inverse_depth;
            normal = Normalized(normal);
            if (!(z >= range.depth_min && z <= range.depth_max) ||
                !(Dot(normal, ray) < 0))
              continue;
            result[static_cast<size_t>(row) * camera.width + col] = {
                normal, -z * Dot(normal, ray)};
          }
        }
      });
  return result;
}

}  // namespace hpm
