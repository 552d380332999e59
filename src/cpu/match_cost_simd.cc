// Compiled once per SIMD target (Highway); see match_cost.h.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "src/cpu/match_cost_simd.cc"
#include "src/cpu/match_cost_simd.h"

#include "src/base/simd_targets.h"

#include <algorithm>
#include <iterator>

#include <hwy/foreach_target.h>
#include <hwy/highway.h>
// Behind foreach_target.h, which compiles this file once per target.
#include "src/cpu/match_pairs-inl.h"

HWY_BEFORE_NAMESPACE();
namespace hpm {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

// 1 / z[i] with a single division. Approximate reciprocals would be as fast,
// but differ from one maker of processors to the other.
template <class D, class V>
HWY_INLINE void InvertThree(D df, V z[3]) {
  const V z01 = hn::Mul(z[0], z[1]);
  const V inverse = hn::Div(hn::Set(df, 1.0f), hn::Mul(z01, z[2]));
  const V inverse01 = hn::Mul(inverse, z[2]);
  z[2] = hn::Mul(inverse, z01);
  const V z0 = z[0];
  z[0] = hn::Mul(inverse01, z[1]);
  z[1] = hn::Mul(inverse01, z0);
}

// hn::ConvertTo() to integers, which on x86 also repairs overflows; here they
// cannot happen.
#if HWY_ARCH_X86 && HWY_TARGET != HWY_SCALAR
template <size_t N>
HWY_INLINE hn::Vec128<int32_t, N> Truncate(hn::Vec128<float, N> v) {
  return hn::Vec128<int32_t, N>{_mm_cvttps_epi32(v.raw)};
}
#if HWY_TARGET <= HWY_AVX2
HWY_INLINE hn::Vec256<int32_t> Truncate(hn::Vec256<float> v) {
  return hn::Vec256<int32_t>{_mm256_cvttps_epi32(v.raw)};
}
#endif
#if HWY_TARGET <= HWY_AVX3
HWY_INLINE hn::Vec512<int32_t> Truncate(hn::Vec512<float> v) {
  return hn::Vec512<int32_t>{_mm512_cvttps_epi32(v.raw)};
}
#endif
#else
template <class V>
HWY_INLINE auto Truncate(V v) {
  return hn::ConvertTo(hn::RebindToSigned<hn::DFromV<V>>(), v);
}
#endif

// The values of the pairs' pixels, from values of `base` and the pixels behind
// it.
template <class D>
class OfPixels {
 public:
  HWY_INLINE OfPixels(D df, const int32_t* pixels, int base)
      : df_(df), base_(base), indices_(Indices(df, pixels, base)) {}

  HWY_INLINE hn::Vec<D> operator()(const float* values) const {
    return hn::TableLookupLanes(hn::Load(df_, values + base_), indices_);
  }

 private:
  static HWY_INLINE auto Indices(D df, const int32_t* pixels, int base) {
    const hn::RebindToSigned<D> di;
    return hn::IndicesFromVec(df,
                              hn::Sub(hn::Load(di, pixels), hn::Set(di, base)));
  }

  D df_;
  int base_;
  decltype(Indices(D(), nullptr, 0)) indices_;
};

// Costs of one vector of pairs, from `first` on, whose pixels lie in one vector
// from `base` on.
template <class D,
          class VF = hn::Vec<D>,
          class VI = hn::Vec<hn::RebindToSigned<D>>>
HWY_INLINE VF PairCosts(D df,
                        const MatchViews& match,
                        const RefPatches& patches,
                        const Pairs& pairs,
                        int first,
                        int base) {
  const hn::RebindToSigned<D> di;
  const hn::RebindToUnsigned<D> du;
  const VF zero = hn::Zero(df);
  const VF one = hn::Set(df, 1.0f);
  const VF half = hn::Set(df, 0.5f);
  const VF max_u = hn::Load(df, pairs.max_u + first);
  const VF max_v = hn::Load(df, pairs.max_v + first);
  const VI stride = hn::Load(di, pairs.stride + first);
  const VI offset = hn::Load(di, pairs.offset + first);
  VF origin[3], dcol[3], drow[3];
  for (int i = 0; i < 3; ++i) {
    origin[i] = hn::Load(df, pairs.origin[i] + first);
    dcol[i] = hn::Load(df, pairs.dcol[i] + first);
    drow[i] = hn::Load(df, pairs.drow[i] + first);
  }

  // Visibility, as IsVisible(). NaN compares false, hence invisible.
  const VF radius =
      hn::Set(df, static_cast<float>(match.shape.offset[kPatchAxis - 1]));
  const VF nearest = hn::NegMulAdd(
      radius, hn::Add(hn::Abs(dcol[2]), hn::Abs(drow[2])), origin[2]);
  const VF u0 = hn::Div(origin[0], origin[2]);
  const VF v0 = hn::Div(origin[1], origin[2]);
  const VF low = hn::Neg(half);
  auto visible =
      hn::And(hn::Gt(nearest, zero), hn::And(hn::Ge(u0, low), hn::Ge(v0, low)));
  visible = hn::And(visible,
                    hn::And(hn::Le(u0, hn::Add(max_u, half)),
                            hn::Le(v0, hn::Add(max_v, half))));
  const int32_t* texels = reinterpret_cast<const int32_t*>(match.origin);
  if (match.any_has_gaps) {
    // As IsInGap(): the pixel under the centre of the patch has the value 0.
    const VF inside_u = hn::Add(hn::IfThenElseZero(visible, u0), half);
    const VF inside_v = hn::Add(hn::IfThenElseZero(visible, v0), half);
    const VI iu = Truncate(hn::Min(hn::Max(inside_u, zero), max_u));
    const VI iv = Truncate(hn::Min(hn::Max(inside_v, zero), max_v));
    const VI at =
        hn::Add(hn::Add(hn::Mul(iv, stride), hn::Add(iu, iu)), offset);
    const VI value =
        hn::And(hn::GatherOffset(di, texels, at), hn::Set(di, 255));
    const VI has_gaps = hn::Load(di, pairs.has_gaps + first);
    const auto shown =
        hn::Or(hn::Ne(value, hn::Zero(di)), hn::Eq(has_gaps, hn::Zero(di)));
    visible = hn::And(visible, hn::RebindMask(df, shown));
  }
  const VF worst = hn::Set(df, kMaxCost);
  if (hn::AllFalse(df, visible)) return worst;
  // Invisible lanes go along on a harmless position.
  for (int i = 0; i < 3; ++i) {
    origin[i] = hn::IfThenElse(visible, origin[i], one);
    dcol[i] = hn::IfThenElseZero(visible, dcol[i]);
    drow[i] = hn::IfThenElseZero(visible, drow[i]);
  }

  const VI byte = hn::Set(di, 255);
  // Byte numbers for TableLookupBytesOr0: byte 1 or 2 of every lane, then
  // zeros.
  const VI first_byte =
      hn::ShiftLeft<2>(hn::And(hn::Iota(di, 0), hn::Set(di, 3)));
  const VI second = hn::Add(first_byte, hn::Set(di, 1 - 256));
  const VI third = hn::Add(first_byte, hn::Set(di, 2 - 256));
  const OfPixels<D> of_pixels(df, pairs.pixel + first, base);
  const VF center = of_pixels(patches.center);
  VF sum_s = zero, sum_ss = zero, sum_rs = zero;
  // All samples of a row, or of two where vectors are short, go through each
  // step together: while one waits for its last step the others fill the time.
  constexpr int kRows = hn::MaxLanes(D()) <= 4 ? 2 : 1;
  constexpr int kSamples = kRows * kPatchAxis;
  static_assert(kPatchAxis % kRows == 0 && kSamples % 3 == 0, "whole groups");
  for (int j = 0; j < kPatchAxis; j += kRows) {
    VF x[kSamples], y[kSamples], inv_z[kSamples];
    for (int r = 0; r < kRows; ++r) {
      const VF down =
          hn::Set(df, static_cast<float>(match.shape.offset[j + r]));
      const VF row_x = hn::MulAdd(down, drow[0], origin[0]);
      const VF row_y = hn::MulAdd(down, drow[1], origin[1]);
      const VF row_z = hn::MulAdd(down, drow[2], origin[2]);
      for (int i = 0; i < kPatchAxis; ++i) {
        const VF right = hn::Set(df, static_cast<float>(match.shape.offset[i]));
        const int k = r * kPatchAxis + i;
        x[k] = hn::MulAdd(right, dcol[0], row_x);
        y[k] = hn::MulAdd(right, dcol[1], row_y);
        inv_z[k] = hn::MulAdd(right, dcol[2], row_z);
      }
    }
    for (int k = 0; k < kSamples; k += 3) InvertThree(df, inv_z + k);
    VF fu[kSamples], fv[kSamples];
    VI index[kSamples];
    for (int k = 0; k < kSamples; ++k) {
      const VF u = hn::Min(hn::Max(hn::Mul(x[k], inv_z[k]), zero), max_u);
      const VF v = hn::Min(hn::Max(hn::Mul(y[k], inv_z[k]), zero), max_v);
      const VI iu = Truncate(u);
      const VI iv = Truncate(v);
      index[k] = hn::Add(hn::Add(hn::Mul(iv, stride), hn::Add(iu, iu)), offset);
      fu[k] = hn::Sub(u, hn::ConvertTo(df, iu));
      fv[k] = hn::Sub(v, hn::ConvertTo(df, iv));
    }
    VI texel[kSamples];
    for (int k = 0; k < kSamples; ++k)
      texel[k] = hn::GatherOffset(di, texels, index[k]);
    VF sample[kSamples];
    for (int k = 0; k < kSamples; ++k) {
      const VF p00 = hn::ConvertTo(df, hn::And(texel[k], byte));
      const VF p10 =
          hn::ConvertTo(df, hn::TableLookupBytesOr0(texel[k], second));
      const VF p01 =
          hn::ConvertTo(df, hn::TableLookupBytesOr0(texel[k], third));
      const VF p11 = hn::ConvertTo(
          df, hn::BitCast(di, hn::ShiftRight<24>(hn::BitCast(du, texel[k]))));
      const VF top = hn::MulAdd(fu[k], hn::Sub(p01, p00), p00);
      const VF bottom = hn::MulAdd(fu[k], hn::Sub(p11, p10), p10);
      sample[k] = hn::Sub(hn::MulAdd(fv[k], hn::Sub(bottom, top), top), center);
    }
    const auto* weight = patches.weight + j * kPatchAxis;
    const auto* weighted = patches.weighted + j * kPatchAxis;
    for (int k = 0; k < kSamples; ++k) {
      const VF ws = hn::Mul(of_pixels(weight[k]), sample[k]);
      sum_s = hn::Add(sum_s, ws);
      sum_ss = hn::MulAdd(ws, sample[k], sum_ss);
      sum_rs = hn::MulAdd(of_pixels(weighted[k]), sample[k], sum_rs);
    }
  }
  const VF min_variance = hn::Set(df, kMinVariance);
  const VF variance = hn::NegMulAdd(sum_s, sum_s, sum_ss);
  const VF covariance = hn::NegMulAdd(of_pixels(patches.mean), sum_s, sum_rs);
  const VF scale = hn::Sqrt(
      hn::Mul(of_pixels(patches.variance), hn::Max(variance, min_variance)));
  const VF cost =
      hn::Min(hn::Max(hn::Sub(one, hn::Div(covariance, scale)), zero), worst);
  return hn::IfThenElse(
      hn::And(visible, hn::Ge(variance, min_variance)), cost, worst);
}

// Costs of one vector of pairs, from `first` on.
template <class D>
HWY_INLINE void StoreCosts(D df,
                           const MatchViews& match,
                           const RefPatches& patches,
                           const Pairs& pairs,
                           int first,
                           int base) {
  alignas(64) float costs[kMaxLanes];
  hn::Store(PairCosts(df, match, patches, pairs, first, base), df, costs);
  const int count =
      std::min(pairs.size - first, static_cast<int>(hn::Lanes(df)));
  for (int i = 0; i < count; ++i) *pairs.cost[first + i] = costs[i];
}

// Costs of the pairs from `first` on, less than a vector. Shorter vectors do,
// where the pixels, too, lie in one.
template <class D>
HWY_INLINE void StoreRest(D df,
                          const MatchViews& match,
                          const RefPatches& patches,
                          const Pairs& pairs,
                          int first,
                          int base) {
  if constexpr (hn::MaxLanes(D()) > 4) {
    const int half = static_cast<int>(hn::Lanes(df)) / 2;
    const bool low = pairs.pixel[pairs.size - 1] < base + half;
    const bool high = pairs.pixel[first] >= base + half;
    if (pairs.size - first <= half && (low || high)) {
      StoreRest(hn::Half<D>(),
                match,
                patches,
                pairs,
                first,
                low ? base : base + half);
      return;
    }
  }
  StoreCosts(df, match, patches, pairs, first, base);
}

// Costs of all full vectors; returns where the rest begins.
HWY_INLINE int StoreFullVectors(const MatchViews& match,
                                const RefPatches& patches,
                                const Pairs& pairs,
                                int base) {
  const DF df;
  const int lanes = static_cast<int>(hn::Lanes(df));
  int first = 0;
  for (; first + lanes <= pairs.size; first += lanes)
    StoreCosts(df, match, patches, pairs, first, base);
  return first;
}

// The requests of as many pixels as there are lanes, from `base` on.
HWY_INLINE void CostsOfPixels(const MatchViews& match,
                              const RefPatches& patches,
                              const MatchRequest* begin,
                              const MatchRequest* end,
                              int base,
                              Pairs* pairs) {
  pairs->size = 0;
  Chosen chosen;
  for (const MatchRequest* request = begin; request != end; ++request) {
    const PlanesInViews& asked = request->asked;
    if (patches.variance[request->pixel] < kMinVariance) {
      std::fill_n(request->costs, asked.num_pairs(), kMaxCost);
      continue;
    }
    GatherViews(match, asked, &chosen);
    for (int p = 0; p < asked.num_planes; ++p) {
      AddPlane(match, *request, chosen, p, pairs);
      if (pairs->size < kFullPairs) continue;
      DropPairs(StoreFullVectors(match, patches, *pairs, base), pairs);
    }
  }
  PadPairs(match, pairs);
  const int first = StoreFullVectors(match, patches, *pairs, base);
  if (first < pairs->size) StoreRest(DF(), match, patches, *pairs, first, base);
}

void MatchCosts(const MatchViews& match,
                const RefPatches& patches,
                const MatchRequest* requests,
                int num_requests) {
  const int lanes = static_cast<int>(hn::Lanes(DF()));
  const MatchRequest* const last = requests + num_requests;
  Pairs pairs;
  while (requests != last) {
    const int base = requests->pixel / lanes * lanes;
    const MatchRequest* end = requests;
    while (end != last && end->pixel < base + lanes) ++end;
    CostsOfPixels(match, patches, requests, end, base, &pairs);
    requests = end;
  }
}

int NumLanes() { return static_cast<int>(hn::Lanes(DF())); }

}  // namespace HWY_NAMESPACE
}  // namespace hpm
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace hpm {
namespace {
HWY_EXPORT(MatchCosts);
HWY_EXPORT(NumLanes);
}  // namespace

int SimdLanes(int64_t target) {
  return HWY_DISPATCH_TABLE(
      NumLanes)[TargetIndex(target, std::size(HWY_DISPATCH_TABLE(NumLanes)))]();
}

MatchCostFunction SimdMatchCosts(int64_t target) {
  return HWY_DISPATCH_TABLE(MatchCosts)[TargetIndex(
      target, std::size(HWY_DISPATCH_TABLE(MatchCosts)))];
}

}  // namespace hpm
#endif  // HWY_ONCE
