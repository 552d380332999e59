#include "src/cpu/geometric_error_scalar.h"

namespace hpm {

void ScalarGeometricErrors(const Camera& ref,
                           const DepthView* depth_views,
                           float max_error,
                           const PlanesInViews& request,
                           float* errors) {
  GeometricErrors(ref,
                  depth_views,
                  max_error,
                  request.col,
                  request.row,
                  request.planes,
                  request.num_planes,
                  request.views,
                  request.num_views,
                  errors);
}

}  // namespace hpm
