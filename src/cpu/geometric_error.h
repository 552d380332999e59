// The reprojection error of src/core/geometric_term.h for many planes at once,
// one source view per SIMD lane.
#pragma once

#include "src/core/geometric_term.h"
#include "src/cpu/match_cost.h"

#include <cstdint>

namespace hpm {

// A source view with its depth map.
struct DepthView {
  ViewWarp to_src, to_ref;
  InverseDepths inverse_depths;  // null steps: there is no depth map
};

// Computes errors[i * num_views + k] of planes[i] in view views[k], in pixels
// and at most max_error; 0 in a view without a depth map, which has no say (an
// error would count against every hypothesis).
using GeometricErrorFunction = void (*)(const Camera& ref,
                                        const DepthView* depth_views,
                                        float max_error,
                                        const MatchRequest& request,
                                        float* errors);

}  // namespace hpm
