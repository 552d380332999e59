// Pairs of a plane and a view, of several pixels, one behind the other: what
// match_cost_simd.cc takes a vector of at a time. Once per SIMD target, hence
// the guard of Highway's kind.
#if defined(HPM_MATCH_PAIRS_INL_H) == defined(HWY_TARGET_TOGGLE)
#ifdef HPM_MATCH_PAIRS_INL_H
#undef HPM_MATCH_PAIRS_INL_H
#else
#define HPM_MATCH_PAIRS_INL_H
#endif

#include "src/cpu/match_cost.h"

#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace hpm {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using DF = hn::ScalableTag<float>;

// Pairs that are evaluated in one go, and room for one more plane in all views
// and the rest of a vector.
constexpr int kMaxLanes = kMaxGroup;
constexpr int kFullPairs = 8 * kMaxLanes;
constexpr int kMaxPairs = kFullPairs + kMaxViews + kMaxLanes;

// Pairs of a plane and a view, of several pixels: a lane each.
struct Pairs {
  int size = 0;
  alignas(64) float origin[3][kMaxPairs];  // the warp
  alignas(64) float dcol[3][kMaxPairs];
  alignas(64) float drow[3][kMaxPairs];
  alignas(64) float max_u[kMaxPairs];
  alignas(64) float max_v[kMaxPairs];
  alignas(64) int32_t stride[kMaxPairs];
  alignas(64) int32_t offset[kMaxPairs];
  alignas(64) int32_t has_gaps[kMaxPairs];
  alignas(64) int32_t pixel[kMaxPairs];  // of the group
  float* cost[kMaxPairs];                // where the result goes
};

// Constants of the chosen views, gathered into consecutive lanes.
struct Chosen {
  alignas(64) float origin[3][kMaxViews + kMaxLanes];  // M (col, row, 1)
  alignas(64) float dcol[3][kMaxViews + kMaxLanes];    // first column of M
  alignas(64) float drow[3][kMaxViews + kMaxLanes];    // second column of M
  alignas(64) float v[3][kMaxViews + kMaxLanes];
};

HWY_INLINE void GatherViews(const MatchViews& match,
                            const PlanesInViews& asked,
                            Chosen* chosen) {
  const float col = static_cast<float>(asked.col);
  const float row = static_cast<float>(asked.row);
  for (int k = 0; k < asked.num_views; ++k) {
    const int view = asked.views[k];
    for (int i = 0; i < 3; ++i) {
      const float a = match.M[3 * i][view], b = match.M[3 * i + 1][view];
      chosen->origin[i][k] = a * col + b * row + match.M[3 * i + 2][view];
      chosen->dcol[i][k] = a;
      chosen->drow[i][k] = b;
      chosen->v[i][k] = match.v[i][view];
    }
  }
}

// One plane of the request in all its views. A vector store past the last view
// is overwritten by what comes next.
HWY_INLINE void AddPlane(const MatchViews& match,
                         const MatchRequest& request,
                         const Chosen& chosen,
                         int plane,
                         Pairs* pairs) {
  const DF df;
  const int lanes = static_cast<int>(hn::Lanes(df));
  const PlanesInViews& asked = request.asked;
  const float col = static_cast<float>(asked.col);
  const float row = static_cast<float>(asked.row);
  const PlaneSlope m = SlopeOf(match.ref, asked.planes[plane]);
  const auto m_col = hn::Set(df, m.col);
  const auto m_row = hn::Set(df, m.row);
  const auto m_here = hn::Set(df, m.col * col + m.row * row + m.constant);
  for (int k = 0; k < asked.num_views; k += lanes) {
    const int pair = pairs->size + k;
    for (int i = 0; i < 3; ++i) {
      const auto v = hn::Load(df, chosen.v[i] + k);
      hn::StoreU(hn::NegMulAdd(m_here, v, hn::Load(df, chosen.origin[i] + k)),
                 df,
                 pairs->origin[i] + pair);
      hn::StoreU(hn::NegMulAdd(m_col, v, hn::Load(df, chosen.dcol[i] + k)),
                 df,
                 pairs->dcol[i] + pair);
      hn::StoreU(hn::NegMulAdd(m_row, v, hn::Load(df, chosen.drow[i] + k)),
                 df,
                 pairs->drow[i] + pair);
    }
  }
  for (int k = 0; k < asked.num_views; ++k) {
    const int pair = pairs->size + k;
    const int view = asked.views[k];
    pairs->max_u[pair] = match.max_u[view];
    pairs->max_v[pair] = match.max_v[view];
    pairs->stride[pair] = match.stride[view];
    pairs->offset[pair] = match.offset[view];
    pairs->has_gaps[pair] = match.has_gaps[view];
    pairs->pixel[pair] = request.pixel;
    pairs->cost[pair] = request.costs + plane * asked.num_views + k;
  }
  pairs->size += asked.num_views;
}

// Moves what lies behind the first pairs to the front; less than a vector.
HWY_INLINE void DropPairs(int count, Pairs* pairs) {
  const DF df;
  const hn::RebindToSigned<DF> di;
  const auto move = [&](auto d, auto* lanes) {
    hn::Store(hn::Load(d, lanes + count), d, lanes);
  };
  for (int i = 0; i < 3; ++i) {
    move(df, pairs->origin[i]);
    move(df, pairs->dcol[i]);
    move(df, pairs->drow[i]);
  }
  move(df, pairs->max_u);
  move(df, pairs->max_v);
  move(di, pairs->stride);
  move(di, pairs->offset);
  move(di, pairs->has_gaps);
  move(di, pairs->pixel);
  pairs->size -= count;
  for (int i = 0; i < pairs->size; ++i) pairs->cost[i] = pairs->cost[count + i];
}

// Lanes behind the last pair: a copy of nothing, seen by no camera.
HWY_INLINE void PadPairs(const MatchViews& match, Pairs* pairs) {
  const int lanes = static_cast<int>(hn::Lanes(DF()));
  for (int pair = pairs->size; pair % lanes != 0; ++pair) {
    pairs->origin[2][pair] = -1;
    pairs->dcol[2][pair] = pairs->drow[2][pair] = 0;
    pairs->max_u[pair] = pairs->max_v[pair] = 0;
    pairs->stride[pair] = 0;
    pairs->offset[pair] = match.offset[0];
    pairs->has_gaps[pair] = 0;
    pairs->pixel[pair] = pairs->pixel[pairs->size - 1];
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace hpm
HWY_AFTER_NAMESPACE();

#endif  // HPM_MATCH_PAIRS_INL_H
