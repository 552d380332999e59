// The reprojection error of src/core/geometric_term.h for many planes at once,
// one source view per SIMD lane.
#pragma once

#include "src/core/geometric_term.h"
#include "src/cpu/match_cost.h"

#include <cstdint>

namespace hpm {

// GeometricErrors() of src/core for the request.
using GeometricErrorFunction = void (*)(const Camera& ref,
                                        const DepthView* depth_views,
                                        float max_error,
                                        const PlanesInViews& request,
                                        float* errors);

}  // namespace hpm
