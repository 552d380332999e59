// What FitLocalPlanes() computes, pixel by pixel: the readable form of
// src/engine/local_planes_simd.cc.
#pragma once

#include "src/core/warp.h"
#include "src/engine/local_planes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace hpm {
namespace readable {

constexpr int kRadius = 3;             // pixels
constexpr float kSigmaSpatial = 1.8f;  // pixels
constexpr float kSigmaGrey = 10;       // grey levels
constexpr int kNumFits = 2;            // the second weighs by the first
// Of the weights: how much the own tilt is trusted where the neighbours say
// little about it.
constexpr float kTrustInTilt = 1e-3f;

// 1/z = constant + col_slope * dcol + row_slope * drow around a pixel.
struct LocalPlane {
  float constant, col_slope, row_slope;
};

// The symmetric system A x = b by Cramer's rule; false where it is singular.
inline bool Solve(const float A[6], const float b[3], LocalPlane* x) {
  const float xx = A[0], xy = A[1], x1 = A[2], yy = A[3], y1 = A[4], w = A[5];
  const float m00 = yy * w - y1 * y1;
  const float m01 = x1 * y1 - xy * w;
  const float m02 = xy * y1 - x1 * yy;
  const float determinant = xx * m00 + xy * m01 + x1 * m02;
  if (!(determinant > 0)) return false;
  const float m11 = xx * w - x1 * x1;
  const float m12 = xy * x1 - xx * y1;
  const float m22 = xx * yy - xy * xy;
  const float inv = 1 / determinant;
  x->col_slope = inv * (m00 * b[0] + m01 * b[1] + m02 * b[2]);
  x->row_slope = inv * (m01 * b[0] + m11 * b[1] + m12 * b[2]);
  x->constant = inv * (m02 * b[0] + m12 * b[1] + m22 * b[2]);
  return std::isfinite(x->constant + x->col_slope + x->row_slope);
}

class Fitter {
 public:
  Fitter(const Camera& camera,
         const GrayImage& image,
         float tolerance,
         const PriorRange& range,
         const HypothesisMap& map)
      : camera_(camera),
        image_(image),
        tolerance_(tolerance),
        range_(range),
        inverse_depths_(map.planes.size()) {
    for (int row = 0; row < map.height; ++row) {
      for (int col = 0; col < map.width; ++col) {
        const size_t at = static_cast<size_t>(row) * map.width + col;
        if (!(map.planes[at].distance > 0)) continue;
        const float z = DepthAt(camera,
                                map.planes[at],
                                static_cast<float>(col),
                                static_cast<float>(row));
        if (z > 0) inverse_depths_[at] = 1 / z;
      }
    }
    for (int d = 0; d < 256; ++d) {
      grey_weights_[d] =
          std::exp(-static_cast<float>(d * d) / (2 * kSigmaGrey * kSigmaGrey));
    }
    for (int i = 0; i <= 2 * kRadius * kRadius; ++i) {
      spatial_weights_[i] = std::exp(-static_cast<float>(i) /
                                     (2 * kSigmaSpatial * kSigmaSpatial));
    }
  }

  Plane Fit(const Plane& own, int col, int row) const {
    const int width = image_.width;
    const size_t at = static_cast<size_t>(row) * width + col;
    if (!(inverse_depths_[at] > 0)) return own;
    const PlaneSlope slope = SlopeOf(camera_, own);
    LocalPlane plane = {inverse_depths_[at], -slope.col, -slope.row};
    for (int i = 0; i < kNumFits; ++i) {
      if (!FitOnce(col, row, &plane)) return own;
    }
    const Vec3f scaled = {
        -plane.col_slope * camera_.fx,
        -plane.row_slope * camera_.fy,
        -(plane.constant +
          plane.col_slope * (camera_.cx - static_cast<float>(col)) +
          plane.row_slope * (camera_.cy - static_cast<float>(row)))};
    const float norm = Norm(scaled);
    if (!(plane.constant * range_.depth_max >= 1 &&
          plane.constant * range_.depth_min <= 1) ||
        !(norm > 0)) {
      return own;
    }
    return {(1 / norm) * scaled, 1 / norm};
  }

 private:
  bool FitOnce(int col, int row, LocalPlane* plane) const {
    const int width = image_.width;
    const int grey = image_.at(col, row);
    const float inv_tolerance = 1 / tolerance_;
    float A[6] = {}, b[3] = {};
    for (int r = std::max(0, row - kRadius);
         r <= std::min(image_.height - 1, row + kRadius);
         ++r) {
      for (int c = std::max(0, col - kRadius);
           c <= std::min(width - 1, col + kRadius);
           ++c) {
        const float inverse_depth =
            inverse_depths_[static_cast<size_t>(r) * width + c];
        if (!(inverse_depth > 0)) continue;
        const float x = static_cast<float>(c - col);
        const float y = static_cast<float>(r - row);
        const float residual = (inverse_depth - plane->constant -
                                plane->col_slope * x - plane->row_slope * y) *
                               inv_tolerance;
        const float robust = 1 / (1 + residual * residual);
        const float w =
            robust * robust * grey_weights_[std::abs(image_.at(c, r) - grey)] *
            spatial_weights_[(c - col) * (c - col) + (r - row) * (r - row)];
        // In units of the tolerance, for float's sake.
        const float z = (inverse_depth - plane->constant) * inv_tolerance;
        A[0] += w * x * x;
        A[1] += w * x * y;
        A[2] += w * x;
        A[3] += w * y * y;
        A[4] += w * y;
        A[5] += w;
        b[0] += w * z * x;
        b[1] += w * z * y;
        b[2] += w * z;
      }
    }
    const float trust = kTrustInTilt * A[5];
    A[0] += trust;
    A[3] += trust;
    b[0] += trust * plane->col_slope * inv_tolerance;
    b[1] += trust * plane->row_slope * inv_tolerance;
    LocalPlane fitted;
    if (!Solve(A, b, &fitted)) return false;
    *plane = {plane->constant + fitted.constant * tolerance_,
              fitted.col_slope * tolerance_,
              fitted.row_slope * tolerance_};
    return true;
  }

  const Camera& camera_;
  const GrayImage& image_;
  const float tolerance_;
  const PriorRange range_;
  std::vector<float> inverse_depths_;  // 0: none
  std::array<float, 256> grey_weights_;
  std::array<float, 2 * kRadius * kRadius + 1> spatial_weights_;
};

inline void FitLocalPlanes(const Camera& camera,
                           const GrayImage& image,
                           float tolerance,
                           const PriorRange& range,
                           HypothesisMap* map) {
  const Fitter fitter(camera, image, tolerance, range, *map);
  for (int row = 0; row < map->height; ++row) {
    for (int col = 0; col < map->width; ++col) {
      Plane* plane = &map->planes[static_cast<size_t>(row) * map->width + col];
      *plane = fitter.Fit(*plane, col, row);
    }
  }
}

}  // namespace readable
}  // namespace hpm
