// Compiled once per SIMD target (Highway); see local_planes_simd.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/engine/local_planes_simd.cc"
#include "src/engine/local_planes_simd.h"

#include "src/base/simd_targets.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <string.h>

HWY_BEFORE_NAMESPACE();
namespace hpm {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kMaxFitLanes>;
using DI = hn::RebindToSigned<DF>;
using DByte = hn::Rebind<uint8_t, DF>;
using VF = hn::Vec<DF>;
using MF = hn::Mask<DF>;

constexpr int kNumFits = 2;  // the second weighs by the first
// Of the weights: how much the own tilt is trusted where the neighbours say
// little about it.
constexpr float kTrustInTilt = 1e-3f;

// 1/z = constant + col_slope * dcol + row_slope * drow around a pixel.
struct LocalPlane {
  VF constant, col_slope, row_slope;
};

// Upper triangle and right side of a symmetric system A x = b.
struct System {
  VF xx, xy, x1, yy, y1, w, bx, by, b1;
};

// By Cramer's rule; returns where it is not singular.
HWY_INLINE MF Solve(DF df, const System& s, LocalPlane* x) {
  const auto minor = [](VF a, VF b, VF c, VF d) HWY_ATTR {
    return hn::Sub(hn::Mul(a, b), hn::Mul(c, d));
  };
  const auto dot = [](VF a, VF b, VF c, VF d, VF e, VF f) HWY_ATTR {
    return hn::Add(hn::Add(hn::Mul(a, b), hn::Mul(c, d)), hn::Mul(e, f));
  };
  const VF m00 = minor(s.yy, s.w, s.y1, s.y1);
  const VF m01 = minor(s.x1, s.y1, s.xy, s.w);
  const VF m02 = minor(s.xy, s.y1, s.x1, s.yy);
  const VF determinant = dot(s.xx, m00, s.xy, m01, s.x1, m02);
  const VF m11 = minor(s.xx, s.w, s.x1, s.x1);
  const VF m12 = minor(s.xy, s.x1, s.xx, s.y1);
  const VF m22 = minor(s.xx, s.yy, s.xy, s.xy);
  const VF inv = hn::Div(hn::Set(df, 1.0f), determinant);
  x->col_slope = hn::Mul(inv, dot(m00, s.bx, m01, s.by, m02, s.b1));
  x->row_slope = hn::Mul(inv, dot(m01, s.bx, m11, s.by, m12, s.b1));
  x->constant = hn::Mul(inv, dot(m02, s.bx, m12, s.by, m22, s.b1));
  return hn::And(
      hn::Gt(determinant, hn::Zero(df)),
      hn::IsFinite(hn::Add(hn::Add(x->constant, x->col_slope), x->row_slope)));
}

// The weights by likeness of the window around each pixel from `col` on.
HWY_INLINE void WeighGrey(DF df,
                          const RowToFit& in,
                          int col,
                          float* HWY_RESTRICT weights) {
  const DI di;
  const DByte bytes;
  const auto own = hn::PromoteTo(di, hn::LoadU(bytes, in.grey + col));
  for (int drow = in.first_drow; drow <= in.last_drow; ++drow) {
    const uint8_t* grey = in.grey + drow * in.grey_stride + col;
    for (int dcol = -kFitRadius; dcol <= kFitRadius; ++dcol) {
      const auto other = hn::PromoteTo(di, hn::LoadU(bytes, grey + dcol));
      hn::Store(
          hn::GatherIndex(df, in.grey_weights, hn::Abs(hn::Sub(other, own))),
          df,
          weights);
      weights += hn::Lanes(df);
    }
  }
}

// Fits to the neighbours, weighted by their distance to *plane; returns where
// that succeeds.
HWY_INLINE MF FitOnce(DF df,
                      const RowToFit& in,
                      int col,
                      const float* HWY_RESTRICT grey_weights,
                      LocalPlane* plane) {
  const VF zero = hn::Zero(df);
  const VF one = hn::Set(df, 1.0f);
  const VF tolerance = hn::Set(df, in.tolerance);
  const VF inv_tolerance = hn::Set(df, 1 / in.tolerance);
  System s = {zero, zero, zero, zero, zero, zero, zero, zero, zero};
  for (int drow = in.first_drow; drow <= in.last_drow; ++drow) {
    const float* inverse_depths =
        in.inverse_depths + drow * in.inverse_depths_stride + col;
    const float* spatial_weights = in.spatial_weights[drow + kFitRadius];
    const VF y = hn::Set(df, static_cast<float>(drow));
    const VF rise = hn::Mul(plane->row_slope, y);
    for (int dcol = -kFitRadius; dcol <= kFitRadius; ++dcol) {
      const VF inverse_depth = hn::LoadU(df, inverse_depths + dcol);
      const MF valid = hn::Gt(inverse_depth, zero);
      const VF x = hn::Set(df, static_cast<float>(dcol));
      const VF above = hn::Sub(inverse_depth, plane->constant);
      const VF residual =
          hn::Mul(hn::Sub(hn::Sub(above, hn::Mul(plane->col_slope, x)), rise),
                  inv_tolerance);
      const VF robust = hn::Div(one, hn::Add(one, hn::Mul(residual, residual)));
      const VF w = hn::IfThenElseZero(
          valid,
          hn::Mul(hn::Mul(hn::Mul(robust, robust), hn::Load(df, grey_weights)),
                  hn::Set(df, spatial_weights[dcol + kFitRadius])));
      grey_weights += hn::Lanes(df);
      // In units of the tolerance, for float's sake.
      const VF z = hn::IfThenElseZero(valid, hn::Mul(above, inv_tolerance));
      const VF wx = hn::Mul(w, x), wy = hn::Mul(w, y), wz = hn::Mul(w, z);
      s.xx = hn::Add(s.xx, hn::Mul(wx, x));
      s.xy = hn::Add(s.xy, hn::Mul(wx, y));
      s.x1 = hn::Add(s.x1, wx);
      s.yy = hn::Add(s.yy, hn::Mul(wy, y));
      s.y1 = hn::Add(s.y1, wy);
      s.w = hn::Add(s.w, w);
      s.bx = hn::Add(s.bx, hn::Mul(wz, x));
      s.by = hn::Add(s.by, hn::Mul(wz, y));
      s.b1 = hn::Add(s.b1, wz);
    }
  }
  const VF trust = hn::Mul(hn::Set(df, kTrustInTilt), s.w);
  const auto trusted = [&](VF slope) HWY_ATTR {
    return hn::Mul(hn::Mul(trust, slope), inv_tolerance);
  };
  s.xx = hn::Add(s.xx, trust);
  s.yy = hn::Add(s.yy, trust);
  s.bx = hn::Add(s.bx, trusted(plane->col_slope));
  s.by = hn::Add(s.by, trusted(plane->row_slope));
  LocalPlane fitted = {zero, zero, zero};
  const MF solved = Solve(df, s, &fitted);
  plane->constant =
      hn::Add(plane->constant, hn::Mul(fitted.constant, tolerance));
  plane->col_slope = hn::Mul(fitted.col_slope, tolerance);
  plane->row_slope = hn::Mul(fitted.row_slope, tolerance);
  return solved;
}

// The pixels from `col` on, a lane each; those behind the row have no inverse
// depth.
HWY_INLINE void FitBlock(DF df, const RowToFit& in, int col, Plane* planes) {
  static_assert(sizeof(Plane) == 4 * sizeof(float), "read as such");
  const Camera& camera = *in.camera;
  const VF zero = hn::Zero(df);
  const VF one = hn::Set(df, 1.0f);
  const VF inverse_depth = hn::LoadU(df, in.inverse_depths + col);
  MF taken = hn::Gt(inverse_depth, zero);
  if (hn::AllFalse(df, taken)) return;
  alignas(64) float grey_weights[kFitSide * kFitSide * kMaxFitLanes];
  WeighGrey(df, in, col, grey_weights);

  float* entries = &planes->normal.x;
  VF nx, ny, nz, distance;
  hn::LoadInterleaved4(df, entries, nx, ny, nz, distance);
  const VF inv_distance = hn::Div(one, distance);
  const VF fx = hn::Set(df, camera.fx), fy = hn::Set(df, camera.fy);
  LocalPlane plane = {inverse_depth,
                      hn::Neg(hn::Mul(hn::Div(nx, fx), inv_distance)),
                      hn::Neg(hn::Mul(hn::Div(ny, fy), inv_distance))};
  for (int i = 0; i < kNumFits; ++i)
    taken = hn::And(taken, FitOnce(df, in, col, grey_weights, &plane));

  const VF x = hn::ConvertTo(df, hn::Iota(DI(), col));
  const VF y = hn::Set(df, static_cast<float>(in.row));
  const VF to_center_x = hn::Sub(hn::Set(df, camera.cx), x);
  const VF to_center_y = hn::Sub(hn::Set(df, camera.cy), y);
  const VF sx = hn::Mul(hn::Neg(plane.col_slope), fx);
  const VF sy = hn::Mul(hn::Neg(plane.row_slope), fy);
  const VF sz = hn::Neg(
      hn::Add(hn::Add(plane.constant, hn::Mul(plane.col_slope, to_center_x)),
              hn::Mul(plane.row_slope, to_center_y)));
  const VF norm = hn::Sqrt(
      hn::Add(hn::Add(hn::Mul(sx, sx), hn::Mul(sy, sy)), hn::Mul(sz, sz)));
  const VF inv_norm = hn::Div(one, norm);
  const auto times = [&](float depth) HWY_ATTR {
    return hn::Mul(plane.constant, hn::Set(df, depth));
  };
  taken = hn::And(taken, hn::Ge(times(in.range.depth_max), one));
  taken = hn::And(taken, hn::Le(times(in.range.depth_min), one));
  taken = hn::And(taken, hn::Gt(norm, zero));
  hn::StoreInterleaved4(hn::IfThenElse(taken, hn::Mul(inv_norm, sx), nx),
                        hn::IfThenElse(taken, hn::Mul(inv_norm, sy), ny),
                        hn::IfThenElse(taken, hn::Mul(inv_norm, sz), nz),
                        hn::IfThenElse(taken, inv_norm, distance),
                        df,
                        entries);
}

void FitRow(const RowToFit& in, Plane* planes) {
  const DF df;
  const int num_lanes = static_cast<int>(hn::Lanes(df));
  int col = 0;
  for (; col + num_lanes <= in.width; col += num_lanes)
    FitBlock(df, in, col, planes + col);
  if (col == in.width) return;
  Plane last[kMaxFitLanes] = {};
  const size_t num_bytes = (in.width - col) * sizeof(Plane);
  memcpy(last, planes + col, num_bytes);
  FitBlock(df, in, col, last);
  memcpy(planes + col, last, num_bytes);
}

}  // namespace HWY_NAMESPACE
}  // namespace hpm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace hpm {
namespace {
HWY_EXPORT(FitRow);
}  // namespace

void FitRow(const RowToFit& row, Plane* planes) {
  HWY_DYNAMIC_DISPATCH(FitRow)(row, planes);
}

}  // namespace hpm
#endif  // HWY_ONCE
