#include "src/cpu/match_cost_scalar.h"

#include "src/cpu/texel_image.h"

#include <cstddef>

namespace hpm {

namespace {

void CostsOf(const MatchViews& match,
             const RefPatch& patch,
             const PlanesInViews& request,
             float* costs) {
  const float col = static_cast<float>(request.col);
  const float row = static_cast<float>(request.row);
  for (int p = 0; p < request.num_planes; ++p) {
    const PlaneSlope slope = SlopeOf(match.ref, request.planes[p]);
    for (int k = 0; k < request.num_views; ++k) {
      const int view = request.views[k];
      ViewWarp warp;
      for (int i = 0; i < 9; ++i) warp.M.m[i] = match.M[i][view];
      warp.v = {match.v[0][view], match.v[1][view], match.v[2][view]};
      const uint8_t* image = match.origin + match.offset[view];
      const auto sample = [&](float u, float v) {
        const float cu = Clamp(u, 0.0f, match.max_u[view]);
        const float cv = Clamp(v, 0.0f, match.max_v[view]);
        const int iu = static_cast<int>(cu), iv = static_cast<int>(cv);
        const float fu = cu - static_cast<float>(iu),
                    fv = cv - static_cast<float>(iv);
        const uint8_t* taps = image +
                              static_cast<ptrdiff_t>(iv) * match.stride[view] +
                              static_cast<ptrdiff_t>(sizeof(Texel)) * iu;
        const float p00 = taps[0], p10 = taps[1];
        const float p01 = taps[2], p11 = taps[3];
        const float top = p00 + fu * (p01 - p00),
                    bottom = p10 + fu * (p11 - p10);
        return top + fv * (bottom - top);
      };
      costs[p * request.num_views + k] =
          MatchCost(match.shape,
                    patch,
                    WarpPatch(warp, slope, col, row),
                    sample,
                    static_cast<int>(match.max_u[view]) + 1,
                    static_cast<int>(match.max_v[view]) + 1,
                    match.has_gaps[view] != 0);
    }
  }
}

}  // namespace

void ScalarMatchCosts(const MatchViews& match,
                      const RefPatches& patches,
                      const MatchRequest* requests,
                      int num_requests) {
  for (int i = 0; i < num_requests; ++i) {
    CostsOf(match,
            patches.Get(requests[i].pixel),
            requests[i].asked,
            requests[i].costs);
  }
}

}  // namespace hpm
