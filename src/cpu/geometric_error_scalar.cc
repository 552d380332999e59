#include "src/cpu/geometric_error_scalar.h"

namespace hpm {

void ScalarGeometricErrors(const Camera& ref,
                           const DepthView* depth_views,
                           float max_error,
                           const MatchRequest& request,
                           float* errors) {
  const float col = static_cast<float>(request.col);
  const float row = static_cast<float>(request.row);
  for (int p = 0; p < request.num_planes; ++p) {
    const PlaneSlope slope = SlopeOf(ref, request.planes[p]);
    for (int k = 0; k < request.num_views; ++k) {
      const DepthView& view = depth_views[request.views[k]];
      float* error = &errors[p * request.num_views + k];
      *error = 0;
      if (view.inverse_depths.steps == nullptr) continue;
      *error = ReprojectionError(
          Reproject(
              view.to_src, view.to_ref, slope, col, row, view.inverse_depths),
          col,
          row,
          max_error);
    }
  }
}

}  // namespace hpm
