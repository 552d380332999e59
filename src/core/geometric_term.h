// Geometric consistency: forward-backward reprojection error of a hypothesis
// against the depth map of a source view (specification section 9; after ACMM).
#pragma once

#include "src/core/warp.h"

#include <math.h>

namespace hpm {

struct GeometricTerm {
  float weight;     // lambda: cost per pixel of error
  float max_error;  // pixels; also the error where the source has no depth
};

// The pixel of the reference image, after going to the source view along the
// hypothesis and back along the depth that the source view found.
// `inverse_depth(u, v)` returns 1/z of the source view at a continuous position
// (pixel centres at integers), 0 where there is none. Working with 1/z makes
// the way back M' (u, v, 1) + v' / z, and bilinear interpolation exact on
// planes.
template <class InverseDepth>
HPM_HD float ReprojectionError(const ViewWarp& to_src,
                               const ViewWarp& to_ref,
                               const PlaneSlope& slope,
                               float col,
                               float row,
                               float max_error,
                               const InverseDepth& inverse_depth) {
  const Vec3f q =
      to_src.M * Vec3f{col, row, 1.0f} -
      (slope.col * col + slope.row * row + slope.constant) * to_src.v;
  if (!(q.z > 0)) return max_error;
  const float u = q.x / q.z;
  const float v = q.y / q.z;
  if (!(u >= -0.5f && v >= -0.5f &&
        u <= static_cast<float>(to_src.width) - 0.5f &&
        v <= static_cast<float>(to_src.height) - 0.5f)) {
    return max_error;
  }
  const float inv_z = inverse_depth(u, v);
  if (!(inv_z > 0)) return max_error;
  const Vec3f p = to_ref.M * Vec3f{u, v, 1.0f} + inv_z * to_ref.v;
  if (!(p.z > 0)) return max_error;
  const float dcol = p.x / p.z - col;
  const float drow = p.y / p.z - row;
  const float error = sqrtf(dcol * dcol + drow * drow);
  return error < max_error ? error : max_error;
}

// Bilinear 1/z where the four taps belong to one surface, else the nearest tap.
// `at(col, row)` returns 1/z at a pixel, 0 = none.
template <class At>
HPM_HD float InterpolateInverseDepth(
    const At& at, int width, int height, float u, float v) {
  constexpr float kSameSurface = 0.02f;  // relative difference
  const float cu = Clamp(u, 0.0f, static_cast<float>(width - 1));
  const float cv = Clamp(v, 0.0f, static_cast<float>(height - 1));
  const int col = static_cast<int>(cu);
  const int row = static_cast<int>(cv);
  const int col1 = col + 1 < width ? col + 1 : col;
  const int row1 = row + 1 < height ? row + 1 : row;
  const float fu = cu - static_cast<float>(col);
  const float fv = cv - static_cast<float>(row);
  const float a = at(col, row), b = at(col1, row), c = at(col, row1),
              d = at(col1, row1);
  const float lo = Smaller(Smaller(a, b), Smaller(c, d));
  const float hi = Larger(Larger(a, b), Larger(c, d));
  if (lo > 0 && hi - lo <= kSameSurface * hi) {
    const float top = a + fu * (b - a);
    const float bottom = c + fu * (d - c);
    return top + fv * (bottom - top);
  }
  return fv < 0.5f ? (fu < 0.5f ? a : b) : (fu < 0.5f ? c : d);
}

}  // namespace hpm
