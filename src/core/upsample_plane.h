// Joint bilateral upsampling of a prior at one pixel (paper, section 3.4;
// unlike its authors' code, planes are evaluated at the pixel, so slanted
// surfaces stay exact; missing taps are skipped; the guide is read where the
// tap lies).
#pragma once

#include "src/core/plane.h"

#include <math.h>

namespace hpm {

constexpr float kUpsampleSigmaSpatial = 0.5f;  // level pixels
constexpr float kUpsampleSigmaColor = 25.5f;   // grey levels
// Taps beyond weigh less than 1e-3 of the nearest.
constexpr int kUpsampleRadius = 1;  // level pixels

// Weight of a tap whose guide differs by d grey levels.
HPM_HD float UpsampleColorWeight(int d) {
  return expf(-static_cast<float>(d * d) /
              (2 * kUpsampleSigmaColor * kUpsampleSigmaColor));
}

// Weight of a tap that lies so many level pixels away.
HPM_HD float UpsampleSpatialWeight(float dx, float dy) {
  return expf(-(dx * dx + dy * dy) /
              (2 * kUpsampleSigmaSpatial * kUpsampleSigmaSpatial));
}

// planes: one per pixel of LevelCamera(camera, level), distance 0 = none.
// guide(col, row): 0..255; spatial_weight(dx, dy), color_weight(d): as above.
// Distance 0 if there is no tap or the depth leaves [depth_min, depth_max].
template <class Guide, class SpatialWeight, class ColorWeight>
HPM_HD Plane UpsamplePlaneAt(const Plane* planes,
                             int level,
                             const Camera& camera,
                             const Guide& guide,
                             const SpatialWeight& spatial_weight,
                             const ColorWeight& color_weight,
                             float depth_min,
                             float depth_max,
                             int col,
                             int row) {
  const int factor = 1 << level;
  const float scale = 1.0f / static_cast<float>(factor);
  const int low_width = (camera.width + factor - 1) / factor;
  const int low_height = (camera.height + factor - 1) / factor;
  const float x = (static_cast<float>(col) + 0.5f) * scale - 0.5f;
  const float y = (static_cast<float>(row) + 0.5f) * scale - 0.5f;
  const Vec3f ray =
      RayAt(camera, static_cast<float>(col), static_cast<float>(row));
  const int grey = guide(col, row);
  const int near_col = col / factor;
  const int near_row = row / factor;
  const Plane none = {{0, 0, 0}, 0};
  float weights = 0, inverse_depth = 0;
  Vec3f normal = {0, 0, 0};
  for (int r = near_row - kUpsampleRadius; r <= near_row + kUpsampleRadius;
       ++r) {
    if (r < 0 || r >= low_height) continue;
    for (int c = near_col - kUpsampleRadius; c <= near_col + kUpsampleRadius;
         ++c) {
      if (c < 0 || c >= low_width) continue;
      const Plane& plane = planes[static_cast<size_t>(r) * low_width + c];
      if (!(plane.distance > 0)) continue;
      const float inv_z = -Dot(plane.normal, ray) / plane.distance;
      if (!(inv_z > 0)) continue;
      const int tap_col = c * factor + factor / 2;
      const int tap_row = r * factor + factor / 2;
      const int tap =
          guide(tap_col < camera.width ? tap_col : camera.width - 1,
                tap_row < camera.height ? tap_row : camera.height - 1);
      const float dx = x - static_cast<float>(c);
      const float dy = y - static_cast<float>(r);
      const float w = spatial_weight(dx, dy) *
                      color_weight(grey > tap ? grey - tap : tap - grey);
      weights += w;
      inverse_depth += w * inv_z;
      normal = normal + w * plane.normal;
    }
  }
  if (!(weights > 0)) return none;
  const float z = weights / inverse_depth;
  // Squares of what all taps of another grey leave would underflow.
  constexpr float kLittleWeight = 1e-6f;
  if (weights < kLittleWeight) normal = (1 / weights) * normal;
  normal = Normalized(normal);
  if (!(z >= depth_min && z <= depth_max) || !(Dot(normal, ray) < 0))
    return none;
  return {normal, -z * Dot(normal, ray)};
}

}  // namespace hpm
