#include "src/core/sampling_pattern.h"

namespace hpm {
namespace {

constexpr int kAcmhStrip = 11;
constexpr int kAcmhV = 7;
constexpr int kNespStrip = 5;
constexpr int kNespPolyline = 8;

struct Offset {
  int col, row;
};

// Quarter turns in the image plane: up -> left -> down -> right.
Offset Rotated(Offset offset, int quarter_turns) {
  for (int i = 0; i < quarter_turns; ++i) offset = {offset.row, -offset.col};
  return offset;
}

// Every second pixel straight up, from `start` on.
Offset StripSample(int start, int k) { return {0, -(start + 2 * k)}; }

// (0,-1), (-1,-2), (+1,-2), (-2,-3), (+2,-3), ...
Offset VSample(int k) {
  const int i = (k + 1) / 2;
  return {k % 2 == 1 ? -i : i, -1 - i};
}

// Left-up polyline from (-5,-6), alternately two left and two up.
Offset PolylineSample(int k) {
  return {-5 - 2 * ((k + 1) / 2), -6 - 2 * (k / 2)};
}

}  // namespace

SamplingPattern MakeSamplingPattern(bool non_local, bool extensible) {
  SamplingPattern pattern = {};
  pattern.max_extensions = extensible ? kMaxExtensions : 0;
  pattern.mask_distance = non_local ? 5 : 1;
  for (int region = 0; region < kNumRegions; ++region) {
    const bool strip = region < 4;
    const int num_base = non_local ? (strip ? kNespStrip : kNespPolyline)
                                   : (strip ? kAcmhStrip : kAcmhV);
    pattern.num_base[region] = num_base;
    for (int k = 0; k < num_base << kMaxExtensions; ++k) {
      Offset offset;
      if (strip) {
        offset = StripSample(non_local ? 5 : 3, k);
      } else {
        offset = non_local ? PolylineSample(k) : VSample(k);
      }
      offset = Rotated(offset, region % 4);
      pattern.dcol[region][k] = static_cast<short>(offset.col);
      pattern.drow[region][k] = static_cast<short>(offset.row);
    }
  }
  return pattern;
}

}  // namespace hpm
