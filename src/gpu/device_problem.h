// One problem as the kernels see it: plain data, pointers into the memory of
// whoever runs the kernels (a card, or the host in the tests).
#pragma once

#include "src/core/checkerboard.h"
#include "src/core/match_cost.h"
#include "src/core/visit.h"

#include <stdint.h>

namespace hpm {

// What the matching cost needs of a source view; one 16-byte aligned record, so
// that a lane fetches it in five wide loads.
struct alignas(16) ViewGeometry {
  float M[9];  // of ViewWarp
  float v[3];
  float max_u, max_v;  // width - 1, height - 1
  int32_t width, height;
  const uint32_t* texels;  // four taps per pixel, see texel_image.h; or null
  uint32_t has_gaps;       // see src/image/gaps.h
  uint32_t padding;
};
static_assert(sizeof(ViewGeometry) == 80, "five loads of 16 bytes");

struct DeviceProblem {
  VisitParams params;
  PatchShape shape;
  SamplingPattern pattern;
  const uint8_t* ref_grey;     // row-major, no padding
  const float* color_weights;  // 2 x 256: ColorWeight(shape, mixed, d)
  const ViewGeometry* views;
  const DepthView* depth_views;  // for the geometric term
  const Vec3f* src_centers;      // in the reference camera frame
  unsigned long long texture;    // layered, one layer per view
};

// Of the reference image, 0..255; clamps at the border.
HPM_HD float GreyAt(const DeviceProblem& problem, int col, int row) {
  const int width = problem.params.ref.width;
  const int height = problem.params.ref.height;
  const int c = col < 0 ? 0 : (col < width ? col : width - 1);
  const int r = row < 0 ? 0 : (row < height ? row : height - 1);
  return static_cast<float>(
      problem.ref_grey[static_cast<size_t>(r) * width + c]);
}

// The window of the reference image at a pixel, read once for all its costs.
HPM_HD RefPatch RefPatchAt(const DeviceProblem& problem, int col, int row) {
  return MakeRefPatch(
      problem.shape,
      [&](int c, int r) { return GreyAt(problem, c, r); },
      [&](bool mixed, float difference) {
        const float* weights = problem.color_weights + (mixed ? 256 : 0);
        return weights[static_cast<int>(difference)];
      },
      col,
      row);
}

}  // namespace hpm
