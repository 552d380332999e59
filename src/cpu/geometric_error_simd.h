// The SIMD targets' reprojection errors.
#pragma once

#include "src/cpu/geometric_error.h"

#include <cstdint>

namespace hpm {

// Of one of Highway's targets, among those that this machine can run.
GeometricErrorFunction SimdGeometricErrors(int64_t target);

}  // namespace hpm
