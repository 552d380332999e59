// Compiled once per SIMD target (Highway); see geometric_error.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/geometric_error_simd.cc"
#include "src/cpu/geometric_error_simd.h"

#include "src/base/simd_targets.h"

#include <iterator>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
#include <string.h>

HWY_BEFORE_NAMESPACE();
namespace hpm {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// Hardly more than four views are drawn for a pixel.
using DF = hn::CappedTag<float, 4>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
constexpr int kMaxLanes = 4;

struct Vec3 {
  VF x, y, z;
};

// What each lane's view contributes, the same for all planes.
struct LaneViews {
  // Row by row M, then v, of ViewWarp.
  alignas(16) float to_src[12][kMaxLanes];
  alignas(16) float to_ref[12][kMaxLanes];
  alignas(16) float max_u[kMaxLanes], max_v[kMaxLanes];
  alignas(16) float step[kMaxLanes];
  alignas(16) float worst[kMaxLanes];  // 0 without a depth map
  const DepthView* views[kMaxLanes];
};

HWY_INLINE void FillLane(const DepthView& view,
                         float max_error,
                         int lane,
                         LaneViews* lanes) {
  for (int i = 0; i < 9; ++i) {
    lanes->to_src[i][lane] = view.to_src.M.m[i];
    lanes->to_ref[i][lane] = view.to_ref.M.m[i];
  }
  const Vec3f& v = view.to_src.v;
  const Vec3f& w = view.to_ref.v;
  lanes->to_src[9][lane] = v.x;
  lanes->to_src[10][lane] = v.y;
  lanes->to_src[11][lane] = v.z;
  lanes->to_ref[9][lane] = w.x;
  lanes->to_ref[10][lane] = w.y;
  lanes->to_ref[11][lane] = w.z;
  lanes->max_u[lane] = static_cast<float>(view.to_src.width - 1);
  lanes->max_v[lane] = static_cast<float>(view.to_src.height - 1);
  lanes->step[lane] = view.inverse_depths.step;
  lanes->worst[lane] = view.HasDepth() ? max_error : 0;
  lanes->views[lane] = &view;
}

// M (u, v, 1)
HWY_INLINE Vec3 Times(DF df, const float (&M)[12][kMaxLanes], VF u, VF v) {
  const auto row = [&](int i) HWY_ATTR {
    return hn::MulAdd(
        hn::Load(df, M[i]),
        u,
        hn::MulAdd(hn::Load(df, M[i + 1]), v, hn::Load(df, M[i + 2])));
  };
  return {row(0), row(3), row(6)};
}

// The four taps around each lane's position, in steps, as
// InterpolateInverseDepth() takes them: a b in the upper row, c d in the lower.
struct Taps {
  alignas(16) int32_t a[kMaxLanes], b[kMaxLanes], c[kMaxLanes], d[kMaxLanes];
};

HWY_INLINE int32_t FourBytes(const uint8_t* from) {
  int32_t bytes;
  memcpy(&bytes, from, sizeof(bytes));
  return bytes;
}

HWY_INLINE void ReadTaps(
    const DepthView& view, int col, int row, int lane, Taps* taps) {
  if (!view.HasDepth()) {
    taps->a[lane] = taps->b[lane] = taps->c[lane] = taps->d[lane] = 0;
    return;
  }
  const size_t width = static_cast<size_t>(view.to_src.width);
  const uint8_t* top =
      view.inverse_depths.steps + kInverseDepthBytes * (row * width + col);
  const size_t right = col + 1 < view.to_src.width ? kInverseDepthBytes : 0;
  const size_t below =
      row + 1 < view.to_src.height ? kInverseDepthBytes * width : 0;
  taps->a[lane] = FourBytes(top);
  taps->b[lane] = FourBytes(top + right);
  taps->c[lane] = FourBytes(top + below);
  taps->d[lane] = FourBytes(top + below + right);
}

// InterpolateInverseDepth() at (u, v), which lies in the lane's image.
HWY_INLINE VF InverseDepthAt(DF df, const LaneViews& lanes, VF u, VF v) {
  const DI di;
  const VF zero = hn::Zero(df);
  const VF one = hn::Set(df, 1.0f);
  const VF half = hn::Set(df, 0.5f);
  u = hn::Min(hn::Max(u, zero), hn::Load(df, lanes.max_u));
  v = hn::Min(hn::Max(v, zero), hn::Load(df, lanes.max_v));
  const auto col = hn::ConvertTo(di, u);
  const auto row = hn::ConvertTo(di, v);
  alignas(16) int32_t cols[kMaxLanes], rows[kMaxLanes];
  hn::Store(col, di, cols);
  hn::Store(row, di, rows);
  Taps taps;
  for (size_t lane = 0; lane < hn::Lanes(df); ++lane) {
    ReadTaps(*lanes.views[lane],
             cols[lane],
             rows[lane],
             static_cast<int>(lane),
             &taps);
  }
  const auto tap = [&](const int32_t* bytes) HWY_ATTR {
    return hn::ConvertTo(df,
                         hn::And(hn::Load(di, bytes), hn::Set(di, 0xffffff)));
  };
  const VF a = tap(taps.a), b = tap(taps.b), c = tap(taps.c), d = tap(taps.d);
  const VF bound = hn::Mul(hn::Set(df, kSameSurface), a);
  const auto is_near = [&](VF other) HWY_ATTR {
    return hn::Le(hn::Abs(hn::Sub(other, a)), bound);
  };
  const auto same = hn::And(hn::And(hn::Gt(a, zero), is_near(b)),
                            hn::And(is_near(c), is_near(d)));
  const auto weight = [&](VF f) HWY_ATTR {
    return hn::IfThenElse(same, f, hn::IfThenZeroElse(hn::Lt(f, half), one));
  };
  const VF wu = weight(hn::Sub(u, hn::ConvertTo(df, col)));
  const VF wv = weight(hn::Sub(v, hn::ConvertTo(df, row)));
  const VF top = hn::MulAdd(wu, hn::Sub(b, a), a);
  const VF bottom = hn::MulAdd(wu, hn::Sub(d, c), c);
  return hn::Mul(hn::Load(df, lanes.step),
                 hn::MulAdd(wv, hn::Sub(bottom, top), top));
}

// Reproject() and ReprojectionError() of one plane; origin: to_src.M (col, row,
// 1); m_here: the plane's -1/z at the pixel.
HWY_INLINE VF ErrorOf(DF df,
                      const LaneViews& lanes,
                      const Vec3& origin,
                      VF m_here,
                      float col,
                      float row) {
  const VF zero = hn::Zero(df);
  const VF one = hn::Set(df, 1.0f);
  const VF half = hn::Set(df, 0.5f);
  const VF low = hn::Neg(half);
  const auto toward = [&](VF start, int i) HWY_ATTR {
    return hn::NegMulAdd(m_here, hn::Load(df, lanes.to_src[i]), start);
  };
  const Vec3 q = {
      toward(origin.x, 9), toward(origin.y, 10), toward(origin.z, 11)};
  const VF inv_q = hn::Div(one, q.z);
  VF u = hn::Mul(q.x, inv_q);
  VF v = hn::Mul(q.y, inv_q);
  // NaN compares false, hence outside.
  const auto inside = hn::And(
      hn::And(hn::Gt(q.z, zero), hn::And(hn::Ge(u, low), hn::Ge(v, low))),
      hn::And(hn::Le(u, hn::Add(hn::Load(df, lanes.max_u), half)),
              hn::Le(v, hn::Add(hn::Load(df, lanes.max_v), half))));
  // Lanes outside go along on a harmless position.
  u = hn::IfThenElseZero(inside, u);
  v = hn::IfThenElseZero(inside, v);
  const VF inv_z = InverseDepthAt(df, lanes, u, v);
  const Vec3 back = Times(df, lanes.to_ref, u, v);
  const auto away = [&](VF start, int i) HWY_ATTR {
    return hn::MulAdd(inv_z, hn::Load(df, lanes.to_ref[i]), start);
  };
  const Vec3 p = {away(back.x, 9), away(back.y, 10), away(back.z, 11)};
  const VF inv_p = hn::Div(one, p.z);
  const VF dcol = hn::MulSub(p.x, inv_p, hn::Set(df, col));
  const VF drow = hn::MulSub(p.y, inv_p, hn::Set(df, row));
  const VF error = hn::Sqrt(hn::MulAdd(dcol, dcol, hn::Mul(drow, drow)));
  const VF worst = hn::Load(df, lanes.worst);
  const auto counts = hn::And(hn::And(inside, hn::Gt(inv_z, zero)),
                              hn::And(hn::Gt(p.z, zero), hn::Lt(error, worst)));
  return hn::IfThenElse(counts, error, worst);
}

void GeometricErrors(const Camera& ref,
                     const DepthView* depth_views,
                     float max_error,
                     const PlanesInViews& request,
                     float* errors) {
  const DF df;
  const int num_lanes = static_cast<int>(hn::Lanes(df));
  const float col = static_cast<float>(request.col);
  const float row = static_cast<float>(request.row);
  for (int first = 0; first < request.num_views; first += num_lanes) {
    const int count = HWY_MIN(num_lanes, request.num_views - first);
    LaneViews lanes;
    for (int lane = 0; lane < num_lanes; ++lane) {
      const int k = first + (lane < count ? lane : 0);
      FillLane(depth_views[request.views[k]], max_error, lane, &lanes);
    }
    const Vec3 origin =
        Times(df, lanes.to_src, hn::Set(df, col), hn::Set(df, row));
    for (int p = 0; p < request.num_planes; ++p) {
      const PlaneSlope m = SlopeOf(ref, request.planes[p]);
      const VF m_here = hn::Set(df, m.col * col + m.row * row + m.constant);
      alignas(16) float of_plane[kMaxLanes];
      hn::Store(ErrorOf(df, lanes, origin, m_here, col, row), df, of_plane);
      for (int lane = 0; lane < count; ++lane)
        errors[p * request.num_views + first + lane] = of_plane[lane];
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace hpm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace hpm {
namespace {
HWY_EXPORT(GeometricErrors);
}  // namespace

GeometricErrorFunction SimdGeometricErrors(int64_t target) {
  return HWY_DISPATCH_TABLE(GeometricErrors)[TargetIndex(
      target, std::size(HWY_DISPATCH_TABLE(GeometricErrors)))];
}

}  // namespace hpm
#endif  // HWY_ONCE
