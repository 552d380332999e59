// The fits of FitLocalPlanes() along a row, a pixel to a SIMD lane. They have
// the same bytes with all of Highway's targets: no lane meets another one, and
// nothing is fused.
#pragma once

#include "src/core/plane.h"
#include "src/prior/planar_prior.h"

#include <cstddef>
#include <cstdint>

namespace hpm {

constexpr int kFitRadius = 3;  // pixels
constexpr int kFitSide = 2 * kFitRadius + 1;
// What may be read of a row before its first pixel and behind its last one.
constexpr int kMaxFitLanes = 16;
constexpr int kFitLeft = kFitRadius, kFitRight = kFitRadius + kMaxFitLanes;

struct RowToFit {
  const Camera* camera;
  float tolerance;  // 1/z
  PriorRange range;
  int row, width;
  // Rows of the window that lie in the image.
  int first_drow, last_drow;
  // At the first pixel of the row; entries from one row to the next.
  const float* inverse_depths;  // 0: none, as there is beside the image
  ptrdiff_t inverse_depths_stride;
  const uint8_t* grey;
  ptrdiff_t grey_stride;
  const float* grey_weights;                 // by difference, 256
  const float (*spatial_weights)[kFitSide];  // [row][col] of the window
};

// Replaces the planes of the row.
void FitRow(const RowToFit& row, Plane* planes);

}  // namespace hpm
