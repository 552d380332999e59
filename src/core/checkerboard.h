// Checkerboard propagation: two half-sweeps per iteration, first the pixels
// with even col + row, then the odd ones. A visit reads only pixels of the
// other colour, so the pixels of one colour are independent of each other.
#pragma once

#include "src/core/limits.h"

namespace hpm {

// Where a visit looks for candidate hypotheses: eight regions, each a list of
// offsets in order of distance. Built on the host (sampling_pattern.cc), plain
// data for the device.
struct SamplingPattern {
  short dcol[kNumRegions][kMaxRegionSamples];
  short drow[kNumRegions][kMaxRegionSamples];
  int num_base[kNumRegions];  // samples before any extension
  int max_extensions;  // 0: regions never grow; each extension doubles the
                       // region
  int mask_distance;   // axial distance of the neighbours whose view masks vote
                       // (view_selection.h)
};

}  // namespace hpm
