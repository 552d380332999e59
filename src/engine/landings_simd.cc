// Compiled once per SIMD target (Highway); see landings_simd.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/engine/landings_simd.cc"
#include "src/engine/landings_simd.h"

#include "src/base/simd_targets.h"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hpm {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::CappedTag<float, kMaxLandingLanes>;
using DI = hn::RebindToSigned<DF>;
using VF = hn::Vec<DF>;
using MF = hn::Mask<DF>;

struct V3 {
  VF x, y, z;
};

HWY_INLINE VF Const(float value) { return hn::Set(DF(), value); }

HWY_INLINE VF Dot3(const V3& a, const V3& b) {
  return hn::Add(hn::Add(hn::Mul(a.x, b.x), hn::Mul(a.y, b.y)),
                 hn::Mul(a.z, b.z));
}

HWY_INLINE V3 Const3(const Vec3f& v) {
  return {Const(v.x), Const(v.y), Const(v.z)};
}

HWY_INLINE V3 Times(const Mat3f& a, const V3& v) {
  return {Dot3({Const(a.m[0]), Const(a.m[1]), Const(a.m[2])}, v),
          Dot3({Const(a.m[3]), Const(a.m[4]), Const(a.m[5])}, v),
          Dot3({Const(a.m[6]), Const(a.m[7]), Const(a.m[8])}, v)};
}

struct Planes {
  V3 normal;
  VF distance;
  MF exist;
};

// PlaneOfSource(), step by step.
HWY_INLINE Planes PlanesOfSource(const SourcePose& pose,
                                 const Surroundings<VF>& s,
                                 VF col,
                                 VF row) {
  const auto bend = [&](VF one, VF other) HWY_ATTR {
    return hn::Abs(hn::Sub(hn::Add(one, other), hn::Mul(Const(2), s.here)));
  };
  const VF most_bend = hn::Max(bend(s.left, s.right), bend(s.above, s.below));
  const VF inv_span = Const(1.0f / (2 * kReach));
  const VF dcol = hn::Mul(hn::Sub(s.right, s.left), inv_span);
  const VF drow = hn::Mul(hn::Sub(s.below, s.above), inv_span);
  const VF slope = hn::Max(hn::Abs(dcol), hn::Abs(drow));
  MF exist = hn::Gt(s.here, Const(0));
  exist = hn::And(exist, hn::Le(most_bend, hn::Mul(Const(kMaxBend), s.here)));
  exist = hn::And(exist, hn::Le(slope, hn::Mul(Const(kMaxSlope), s.here)));
  const VF constant =
      hn::Sub(hn::Sub(s.here, hn::Mul(dcol, col)), hn::Mul(drow, row));
  const V3 n = {hn::Mul(dcol, Const(pose.src.fx)),
                hn::Mul(drow, Const(pose.src.fy)),
                hn::Add(hn::Add(hn::Mul(dcol, Const(pose.src.cx)),
                                hn::Mul(drow, Const(pose.src.cy))),
                        constant)};
  const VF inv_length = hn::Div(Const(1), hn::Sqrt(Dot3(n, n)));
  const VF back = hn::Neg(inv_length);
  const V3 normal = {
      hn::Mul(back, n.x), hn::Mul(back, n.y), hn::Mul(back, n.z)};
  return {Times(pose.rotation, normal),
          hn::Add(inv_length, Dot3(normal, Const3(pose.ref_center))),
          exist};
}

HWY_INLINE void LandBlock(const SourcePose& pose,
                          const Surroundings<VF>& surroundings,
                          int first_col,
                          int step,
                          int first_row,
                          Landing* landings) {
  static_assert(sizeof(Landing) == 3 * sizeof(float), "written as such");
  const DF df;
  const DI di;
  const VF one = Const(1), half = Const(0.5f), zero = Const(0);
  const VF col =
      hn::ConvertTo(df,
                    hn::Add(hn::Mul(hn::Iota(di, 0), hn::Set(di, step)),
                            hn::Set(di, first_col)));
  const VF row = Const(static_cast<float>(first_row));
  const V3 straight = Times(pose.to_ref.M, {col, row, one});
  const V3 shift = Const3(pose.to_ref.v);
  const VF here = surroundings.here;
  const V3 q = {hn::Add(straight.x, hn::Mul(here, shift.x)),
                hn::Add(straight.y, hn::Mul(here, shift.y)),
                hn::Add(straight.z, hn::Mul(here, shift.z))};
  const VF u = hn::Div(q.x, q.z), v = hn::Div(q.y, q.z);
  const VF right = Const(static_cast<float>(pose.ref.width) - 0.5f);
  const VF bottom = Const(static_cast<float>(pose.ref.height) - 0.5f);
  MF lands = hn::Gt(q.z, zero);
  lands = hn::And(lands, hn::And(hn::Gt(u, hn::Neg(half)), hn::Lt(u, right)));
  lands = hn::And(lands, hn::And(hn::Gt(v, hn::Neg(half)), hn::Lt(v, bottom)));
  // Not negative where it counts, so that cutting off rounds.
  const auto ref_col =
      hn::ConvertTo(di, hn::IfThenElseZero(lands, hn::Add(u, half)));
  const auto ref_row =
      hn::ConvertTo(di, hn::IfThenElseZero(lands, hn::Add(v, half)));
  const V3 ray = {
      hn::Div(hn::Sub(hn::ConvertTo(df, ref_col), Const(pose.ref.cx)),
              Const(pose.ref.fx)),
      hn::Div(hn::Sub(hn::ConvertTo(df, ref_row), Const(pose.ref.cy)),
              Const(pose.ref.fy)),
      one};

  const Planes planes = PlanesOfSource(pose, surroundings, col, row);
  const VF facing = Dot3(planes.normal, ray);
  lands = hn::And(lands, planes.exist);
  lands = hn::And(lands, hn::Gt(planes.distance, zero));
  lands = hn::And(
      lands,
      hn::Lt(facing, hn::Mul(Const(-kMinFacing), hn::Sqrt(Dot3(ray, ray)))));
  const VF z = hn::Div(hn::Neg(planes.distance), facing);
  lands = hn::And(lands, hn::Ge(z, Const(pose.z_min)));
  lands = hn::And(lands, hn::Le(z, Const(pose.z_max)));
  hn::StoreInterleaved3(
      hn::IfThenElse(
          lands, hn::BitCast(df, ref_col), hn::BitCast(df, hn::Set(di, -1))),
      hn::BitCast(df, ref_row),
      hn::Div(one, z),
      df,
      reinterpret_cast<float*>(landings));
}

void LandRow(const SourcePose& pose,
             const Surroundings<const float*>& in,
             int col,
             int step,
             int row,
             int num,
             Landing* landings) {
  const DF df;
  for (int i = 0; i < num; i += static_cast<int>(hn::Lanes(df))) {
    LandBlock(pose,
              {hn::LoadU(df, in.here + i),
               hn::LoadU(df, in.left + i),
               hn::LoadU(df, in.right + i),
               hn::LoadU(df, in.above + i),
               hn::LoadU(df, in.below + i)},
              col + step * i,
              step,
              row,
              landings + i);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace hpm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

#include <algorithm>
#include <cmath>

namespace hpm {
namespace {
HWY_EXPORT(LandRow);
}  // namespace

Plane PlaneOfSource(const SourcePose& pose,
                    const Surroundings<float>& s,
                    int col,
                    int row) {
  const float bend = std::max(std::fabs(s.left + s.right - 2 * s.here),
                              std::fabs(s.above + s.below - 2 * s.here));
  const float dcol = (s.right - s.left) / (2 * kReach);
  const float drow = (s.below - s.above) / (2 * kReach);
  const float slope = std::max(std::fabs(dcol), std::fabs(drow));
  if (!(s.here > 0 && bend <= kMaxBend * s.here && slope <= kMaxSlope * s.here))
    return {{0, 0, 0}, 0};
  // 1/z = dcol * col + drow * row + constant, hence n . X = 1 with this n.
  const float constant =
      s.here - dcol * static_cast<float>(col) - drow * static_cast<float>(row);
  const Vec3f n = {dcol * pose.src.fx,
                   drow * pose.src.fy,
                   dcol * pose.src.cx + drow * pose.src.cy + constant};
  const float inv_length = 1 / Norm(n);
  const Vec3f normal = -inv_length * n;
  return {pose.rotation * normal, inv_length + Dot(normal, pose.ref_center)};
}

void LandRow(const SourcePose& pose,
             const Surroundings<const float*>& inverse_depths,
             int col,
             int step,
             int row,
             int num,
             Landing* landings) {
  HWY_DYNAMIC_DISPATCH(LandRow)
  (pose, inverse_depths, col, step, row, num, landings);
}

}  // namespace hpm
#endif  // HWY_ONCE
