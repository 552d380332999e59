// Matching cost: 1 - bilaterally weighted NCC of a plane hypothesis between the
// reference patch and its warp in one source view, as ACMH has it. This is the
// readable scalar form; backends bring their own and are tested against it.
#pragma once

#include "src/core/limits.h"
#include "src/core/warp.h"

#include <math.h>

namespace hpm {

// Window geometry and weights, the same for all pixels.
struct PatchShape {
  int offset[kPatchAxis];     // pixels, per axis
  float spatial[kPatchSize];  // exp(-|q - p| / (2 sigma_spatial^2)), row-major
  float color_falloff;        // 1 / (2 sigma_color^2), per grey level
  float cut_color;            // grey levels; 0: not cut
  // Reference pixels of value 0 show nothing (src/image/gaps.h).
  bool ref_has_gaps;
};

// Weight of a sample whose grey value differs by `difference` >= 0 from the
// centre's. ACMH's exponential has a long tail: one edge in the window
// outweighs the faint shading of a plain wall and pulls the wall to the edge's
// depth. The Gaussian of cut_color cuts the tail; one wider by a quarter does
// in a mixed window, whose texture all over would have little weight left.
HPM_HD float ColorWeight(const PatchShape& shape,
                         bool mixed,
                         float difference) {
  const float cut = mixed ? 1.25f * shape.cut_color : shape.cut_color;
  const float off = cut > 0 ? difference / cut : 0;
  return expf(-difference * shape.color_falloff - 0.5f * off * off);
}

HPM_HD PatchShape MakePatchShape(int radius,
                                 float sigma_spatial,
                                 float sigma_color,
                                 float cut_color) {
  PatchShape shape;
  for (int i = 0; i < kPatchAxis; ++i) {
    shape.offset[i] = static_cast<int>(
        floorf(static_cast<float>(radius * (2 * i - kPatchAxis + 1)) /
                   (kPatchAxis - 1) +
               0.5f));
  }
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const float x = static_cast<float>(shape.offset[i]);
      const float y = static_cast<float>(shape.offset[j]);
      shape.spatial[j * kPatchAxis + i] =
          expf(-sqrtf(x * x + y * y) / (2 * sigma_spatial * sigma_spatial));
    }
  }
  shape.color_falloff = 1 / (2 * sigma_color * sigma_color);
  shape.ref_has_gaps = false;
  shape.cut_color = cut_color;
  return shape;
}

// What a visit needs of the reference image, once per pixel. Grey values are
// taken relative to the centre pixel, which keeps float32 sums exact enough on
// nearly constant windows.
struct RefPatch {
  float weight[kPatchSize];    // bilateral, sum 1
  float weighted[kPatchSize];  // weight * value
  float center;                // grey value of the centre pixel, 0..255
  float mean;                  // weighted, of value - center
  float variance;              // weighted
};

// `grey(col, row)` returns 0..255 and clamps at the border.
// `color_weight(mixed, d)` returns ColorWeight(shape, mixed, d).
template <class Grey, class ColorWeight>
HPM_HD RefPatch MakeRefPatch(const PatchShape& shape,
                             const Grey& grey,
                             const ColorWeight& color_weight,
                             int col,
                             int row) {
  RefPatch patch;
  patch.center = grey(col, row);
  const auto shows_nothing = [&](float value) {
    return shape.ref_has_gaps && value == 0 && patch.center > 0;
  };
  // A window is mixed when less than a third of what it shows is closer to its
  // centre than cut_color.
  int num_shown = 0, num_close = 0;
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const float value = grey(col + shape.offset[i], row + shape.offset[j]);
      if (shows_nothing(value)) continue;
      ++num_shown;
      num_close += fabsf(value - patch.center) < shape.cut_color;
    }
  }
  const bool mixed = 3 * num_close < num_shown;
  float sum = 0, sum_r = 0, sum_rr = 0;
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const int k = j * kPatchAxis + i;
      const float value = grey(col + shape.offset[i], row + shape.offset[j]);
      const float r = value - patch.center;
      float w = shape.spatial[k] * color_weight(mixed, fabsf(r));
      if (shows_nothing(value)) w = 0;
      patch.weight[k] = w;
      patch.weighted[k] = w * r;
      sum += w;
      sum_r += w * r;
      sum_rr += w * r * r;
    }
  }
  const float inv_sum = 1.0f / sum;
  for (int k = 0; k < kPatchSize; ++k) {
    patch.weight[k] *= inv_sum;
    patch.weighted[k] *= inv_sum;
  }
  patch.mean = sum_r * inv_sum;
  patch.variance = sum_rr * inv_sum - patch.mean * patch.mean;
  // Then nothing matches.
  if (shape.ref_has_gaps && patch.center == 0) patch.variance = 0;
  return patch;
}

// Whether the whole patch lies in front of the source camera and its centre
// inside the source image.
HPM_HD bool IsVisible(const PatchWarp& warp,
                      const PatchShape& shape,
                      int width,
                      int height) {
  const float radius = static_cast<float>(shape.offset[kPatchAxis - 1]);
  const float nearest =
      warp.origin.z - radius * (fabsf(warp.dcol.z) + fabsf(warp.drow.z));
  if (!(nearest > 0)) return false;
  const float u = warp.origin.x / warp.origin.z;
  const float v = warp.origin.y / warp.origin.z;
  return u >= -0.5f && v >= -0.5f && u <= static_cast<float>(width) - 0.5f &&
         v <= static_cast<float>(height) - 0.5f;
}

// Whether the patch's centre lies where the source image shows nothing (then 0
// stands for that). `sample` as below.
template <class Sample>
HPM_HD bool IsInGap(const PatchWarp& warp, const Sample& sample) {
  const float u = warp.origin.x / warp.origin.z;
  const float v = warp.origin.y / warp.origin.z;
  return sample(floorf(u + 0.5f), floorf(v + 0.5f)) < 0.5f;
}

// `sample(u, v)` returns the bilinearly interpolated source grey value, clamped
// at the border. has_gaps: of the source image. Result in [0, kMaxCost].
template <class Sample>
HPM_HD float MatchCost(const PatchShape& shape,
                       const RefPatch& ref,
                       const PatchWarp& warp,
                       const Sample& sample,
                       int width,
                       int height,
                       bool has_gaps = false) {
  if (ref.variance < kMinVariance || !IsVisible(warp, shape, width, height) ||
      (has_gaps && IsInGap(warp, sample))) {
    return kMaxCost;
  }
  float sum_s = 0, sum_ss = 0, sum_rs = 0;
  for (int j = 0; j < kPatchAxis; ++j) {
    for (int i = 0; i < kPatchAxis; ++i) {
      const int k = j * kPatchAxis + i;
      const Vec3f q = warp.origin +
                      static_cast<float>(shape.offset[i]) * warp.dcol +
                      static_cast<float>(shape.offset[j]) * warp.drow;
      const float s = sample(q.x / q.z, q.y / q.z) - ref.center;
      sum_s += ref.weight[k] * s;
      sum_ss += ref.weight[k] * s * s;
      sum_rs += ref.weighted[k] * s;
    }
  }
  const float variance = sum_ss - sum_s * sum_s;
  if (variance < kMinVariance) return kMaxCost;
  const float covariance = sum_rs - ref.mean * sum_s;
  return Clamp(
      1.0f - covariance / sqrtf(ref.variance * variance), 0.0f, kMaxCost);
}

}  // namespace hpm
