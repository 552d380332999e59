// Clean-up after a run, from ACMH's code: median of depths in a star of the
// other colour. The normal stays, the plane moves along.
#pragma once

#include "src/core/pixel_state.h"
#include "src/core/vec.h"

namespace hpm {

constexpr float kPerfectCost =
    0.001f;  // pixels at least this good are left alone

HPM_HD void MedianFilterPixel(const Camera& camera,
                              const PixelState& state,
                              int col,
                              int row) {
  const int at = row * state.width + col;
  if (state.costs[at] < kPerfectCost) return;
  constexpr int kNumNeighbours = 20;
  const signed char offsets[kNumNeighbours][2] = {
      {0, -1},  {0, -3}, {0, -5},  {0, 1},  {0, 3},  {0, 5},  {-1, 0},
      {-3, 0},  {-5, 0}, {1, 0},   {3, 0},  {5, 0},  {2, -1}, {2, 1},
      {-2, -1}, {-2, 1}, {-1, -2}, {1, -2}, {-1, 2}, {1, 2}};
  // Of the smaller half and the median, sorted: the median of `count` depths
  // never lies behind.
  constexpr int kNumKept = kNumNeighbours / 2 + 1;
  float depths[kNumKept];
  int count = 0;
  for (int k = -1; k < kNumNeighbours; ++k) {
    const int c = k < 0 ? col : col + offsets[k][0];
    const int r = k < 0 ? row : row + offsets[k][1];
    if (c < 0 || r < 0 || c >= state.width || r >= state.height) continue;
    float z = DepthAt(camera,
                      state.planes[r * state.width + c],
                      static_cast<float>(c),
                      static_cast<float>(r));
    // Insertion without a branch that nothing could predict.
    const int num_kept = count < kNumKept ? count : kNumKept;
    for (int i = 0; i < num_kept; ++i) {
      const float smaller = Smaller(depths[i], z);
      z = Larger(depths[i], z);
      depths[i] = smaller;
    }
    if (count < kNumKept) depths[count] = z;
    ++count;
  }
  const float median = count % 2 == 1
                           ? depths[count / 2]
                           : 0.5f * (depths[count / 2 - 1] + depths[count / 2]);
  state.planes[at] = PlaneFromDepth(camera,
                                    static_cast<float>(col),
                                    static_cast<float>(row),
                                    median,
                                    state.planes[at].normal);
}

}  // namespace hpm
