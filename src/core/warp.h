// Plane-induced homography from the reference image to a source image.
// H = K_s (R - t n^T / d) K_r^-1 = M - v m^T: M and v belong to the view, m to
// the hypothesis, so one (hypothesis, view) pair costs nine multiply-adds.
#pragma once

#include "src/core/plane.h"

namespace hpm {

// M = K_s R_rel K_r^-1 and v = K_s t_rel of one source view.
struct ViewWarp {
  Mat3f M;
  Vec3f v;
  int width, height;  // of the source image
};

// m = K_r^-T n / d; m . (col, row, 1) is -1 / z.
struct PlaneSlope {
  float col, row, constant;
};

// Homogeneous source position of reference pixel (col + i, row + j):
// origin + i * dcol + j * drow; integer positions are source pixel centres.
struct PatchWarp {
  Vec3f origin, dcol, drow;
};

HPM_HD ViewWarp MakeViewWarp(const Camera& ref, const Camera& src) {
  const Mat3f R = src.R * Transposed(ref.R);
  const Vec3f t = src.t - R * ref.t;
  const Mat3f K = {{src.fx, 0, src.cx, 0, src.fy, src.cy, 0, 0, 1}};
  const Mat3f K_inv = {{1 / ref.fx,
                        0,
                        -ref.cx / ref.fx,
                        0,
                        1 / ref.fy,
                        -ref.cy / ref.fy,
                        0,
                        0,
                        1}};
  return {K * (R * K_inv), K * t, src.width, src.height};
}

HPM_HD PlaneSlope SlopeOf(const Camera& ref, const Plane& plane) {
  const float col = plane.normal.x / ref.fx;
  const float row = plane.normal.y / ref.fy;
  const float inv_d = 1.0f / plane.distance;
  return {col * inv_d,
          row * inv_d,
          (plane.normal.z - col * ref.cx - row * ref.cy) * inv_d};
}

HPM_HD PatchWarp WarpPatch(const ViewWarp& view,
                           const PlaneSlope& m,
                           float col,
                           float row) {
  const float neg_inv_z = m.col * col + m.row * row + m.constant;
  const float* M = view.M.m;
  return {view.M * Vec3f{col, row, 1.0f} - neg_inv_z * view.v,
          Vec3f{M[0], M[3], M[6]} - m.col * view.v,
          Vec3f{M[1], M[4], M[7]} - m.row * view.v};
}

}  // namespace hpm
