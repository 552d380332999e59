// The sampling patterns of the methods, as data.
#pragma once

#include "src/core/checkerboard.h"

namespace hpm {

// non_local = false: ACMH's strips and Vs around the pixel (Xu and Tao 2019);
//   the V moved by one pixel, so that every offset reaches the other colour.
// non_local = true: NESP, nothing within radius 4 (paper, section 3.2): four
//   strips of 5 samples and four polylines of 8, a pinwheel of odd offsets.
// extensible: regions may double up to three times (section 3.2, N_ext = 3).
SamplingPattern MakeSamplingPattern(bool non_local, bool extensible);

}  // namespace hpm
