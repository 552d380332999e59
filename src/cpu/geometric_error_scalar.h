// The reprojection error of src/core/geometric_term.h as it stands there: the
// reference for all SIMD targets, and part of a target of its own.
#pragma once

#include "src/cpu/geometric_error.h"

namespace hpm {

// See GeometricErrorFunction.
void ScalarGeometricErrors(const Camera& ref,
                           const DepthView* depth_views,
                           float max_error,
                           const PlanesInViews& request,
                           float* errors);

}  // namespace hpm
