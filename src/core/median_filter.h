// Clean-up after a run: median of depths in a star of the other colour
// (specification section 10.1). The normal stays, the plane moves along.
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
  float depths[kNumNeighbours + 1];
  int count = 0;
  for (int k = -1; k < kNumNeighbours; ++k) {
    const int c = k < 0 ? col : col + offsets[k][0];
    const int r = k < 0 ? row : row + offsets[k][1];
    if (c < 0 || r < 0 || c >= state.width || r >= state.height) continue;
    const float z = DepthAt(camera,
                            state.planes[r * state.width + c],
                            static_cast<float>(c),
                            static_cast<float>(r));
    int i = count++;
    for (; i > 0 && depths[i - 1] > z; --i) depths[i] = depths[i - 1];
    depths[i] = z;
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
