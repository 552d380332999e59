// Models far from their origin, as geo-registration leaves them.
#pragma once

#include "colmap_plugin/workspace/problem.h"

#include <vector>

namespace hpm {

// Our maps do not suffer: every problem has its origin at its reference. But
// COLMAP's fusion and meshing, and PLY files, hold positions in the model's
// frame as float32. Says so, once, with what to do about it, if float32 is too
// coarse there for the pixels of some problem.
void WarnOfFarOrigin(const Workspace& workspace,
                     const std::vector<StereoProblem>& problems,
                     const LogSink& log);

}  // namespace hpm
