// Geometric consistency: forward-backward reprojection error of a hypothesis
// against the depth map of a source view (paper, section 3.4; after ACMM).
#pragma once

#include "src/core/warp.h"

#include <math.h>
#include <stddef.h>
#include <stdint.h>
#include <string.h>

namespace hpm {

struct GeometricTerm {
  float weight;     // lambda: cost per pixel of error
  float max_error;  // pixels; also the error where the source has no depth
};

// Where the surface that a source view found lies in the reference image.
struct Reprojection {
  float col, row;
  float inverse_depth;  // 1/z in the reference camera; 0: there is none
};

// Whether the hypothesis lies inside the source image; where, in its pixels.
HPM_HD bool IsSeen(const ViewWarp& to_src,
                   const PlaneSlope& slope,
                   float col,
                   float row,
                   float* u,
                   float* v) {
  const Vec3f q =
      to_src.M * Vec3f{col, row, 1.0f} -
      (slope.col * col + slope.row * row + slope.constant) * to_src.v;
  if (!(q.z > 0)) return false;
  const float inv_q = 1 / q.z;
  *u = q.x * inv_q;
  *v = q.y * inv_q;
  return *u >= -0.5f && *v >= -0.5f &&
         *u <= static_cast<float>(to_src.width) - 0.5f &&
         *v <= static_cast<float>(to_src.height) - 0.5f;
}

// Goes to the source view along the hypothesis and back along the depth that
// the source view found. `inverse_depth(u, v)` returns 1/z of the source view
// at a continuous position (pixel centres at integers), 0 where there is none.
// Working with 1/z makes the way back M' (u, v, 1) + v' / z, and bilinear
// interpolation exact on planes.
template <class InverseDepth>
HPM_HD Reprojection Reproject(const ViewWarp& to_src,
                              const ViewWarp& to_ref,
                              const PlaneSlope& slope,
                              float col,
                              float row,
                              const InverseDepth& inverse_depth) {
  const Reprojection none = {0, 0, 0};
  float u, v;
  if (!IsSeen(to_src, slope, col, row, &u, &v)) return none;
  const float inv_z = inverse_depth(u, v);
  if (!(inv_z > 0)) return none;
  const Vec3f p = to_ref.M * Vec3f{u, v, 1.0f} + inv_z * to_ref.v;
  if (!(p.z > 0)) return none;
  const float inv_p = 1 / p.z;
  return {p.x * inv_p, p.y * inv_p, inv_z * inv_p};
}

// Pixels between (col, row) and where the source view brings it back to.
HPM_HD float ReprojectionError(const Reprojection& reprojection,
                               float col,
                               float row,
                               float max_error) {
  if (!(reprojection.inverse_depth > 0)) return max_error;
  const float dcol = reprojection.col - col;
  const float drow = reprojection.row - row;
  const float error = sqrtf(dcol * dcol + drow * drow);
  return error < max_error ? error : max_error;
}

// 1/z of a source view at its pixel centres, row-major, 0 = no depth, in steps
// of 24 bits: three bytes each, lowest first, and one byte behind the last. A
// null pointer: the view has no depth map. Non-owning.
struct InverseDepths {
  const uint8_t* steps;
  float step;
};

constexpr int kInverseDepthBytes = 3;

// In steps; exact in a float.
HPM_HD float InverseDepthSteps(const uint8_t* steps, size_t at) {
  const uint8_t* bytes = steps + kInverseDepthBytes * at;
#if defined(__CUDA_ARCH__)
  return static_cast<float>(bytes[0] | bytes[1] << 8 | bytes[2] << 16);
#else
  uint32_t four;
  memcpy(&four, bytes, sizeof(four));
  return static_cast<float>(static_cast<int>(four & 0xffffff));
#endif
}

constexpr float kSameSurface = 0.02f;  // relative to the first tap

// Bilinear 1/z where the four taps belong to one surface, else the nearest tap.
HPM_HD float InterpolateInverseDepth(
    const InverseDepths& map, int width, int height, float u, float v) {
  const float cu = Clamp(u, 0.0f, static_cast<float>(width - 1));
  const float cv = Clamp(v, 0.0f, static_cast<float>(height - 1));
  const int col = static_cast<int>(cu);
  const int row = static_cast<int>(cv);
  const int col1 = col + 1 < width ? col + 1 : col;
  const size_t top_row = static_cast<size_t>(row) * width;
  const size_t bottom_row = row + 1 < height ? top_row + width : top_row;
  const float fu = cu - static_cast<float>(col);
  const float fv = cv - static_cast<float>(row);
  const float a = InverseDepthSteps(map.steps, top_row + col),
              b = InverseDepthSteps(map.steps, top_row + col1),
              c = InverseDepthSteps(map.steps, bottom_row + col),
              d = InverseDepthSteps(map.steps, bottom_row + col1);
  const float bound = kSameSurface * a;
  // Bitwise: one branch for all, which is nearly always the same.
  const bool same = (a > 0) & (fabsf(b - a) <= bound) &
                    (fabsf(c - a) <= bound) & (fabsf(d - a) <= bound);
  // Weights of 0 or 1 give the nearest tap exactly.
  const float wu = same ? fu : (fu < 0.5f ? 0.0f : 1.0f);
  const float wv = same ? fv : (fv < 0.5f ? 0.0f : 1.0f);
  const float top = a + wu * (b - a);
  const float bottom = c + wu * (d - c);
  return map.step * (top + wv * (bottom - top));
}

// A source view and the depth it found.
struct DepthView {
  ViewWarp to_src, to_ref;
  InverseDepths inverse_depths;  // null steps: there is no depth map

  HPM_HD_MEMBER bool HasDepth() const {
    return inverse_depths.steps != nullptr;
  }
};

// Of a view with a depth map.
HPM_HD Reprojection Reproject(const DepthView& view,
                              const PlaneSlope& slope,
                              float col,
                              float row) {
  const ViewWarp& to_src = view.to_src;
  return Reproject(to_src, view.to_ref, slope, col, row, [&](float u, float v) {
    return InterpolateInverseDepth(
        view.inverse_depths, to_src.width, to_src.height, u, v);
  });
}

// errors[i * num_views + k] of planes[i] in depth_views[views[k]], pixels, at
// most max_error; 0 in a view without a depth map, which has no say: an error
// would count against every hypothesis.
HPM_HD void GeometricErrors(const Camera& ref,
                            const DepthView* depth_views,
                            float max_error,
                            int col,
                            int row,
                            const Plane* planes,
                            int num_planes,
                            const uint8_t* views,
                            int num_views,
                            float* errors) {
  const float x = static_cast<float>(col);
  const float y = static_cast<float>(row);
  for (int i = 0; i < num_planes; ++i) {
    const PlaneSlope slope = SlopeOf(ref, planes[i]);
    for (int k = 0; k < num_views; ++k) {
      const DepthView& view = depth_views[views[k]];
      errors[i * num_views + k] =
          view.HasDepth()
              ? ReprojectionError(Reproject(view, slope, x, y), x, y, max_error)
              : 0.0f;
    }
  }
}

}  // namespace hpm
