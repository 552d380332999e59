// The state of a run, one entry per pixel of the reference image, row-major.
#pragma once

#include "src/core/limits.h"
#include "src/core/plane.h"

#include <stdint.h>

namespace hpm {

// In PixelState::visits: a pixel that every iteration visits.
constexpr uint8_t kAllVisits = 255;

// Non-owning; the backend holds the arrays.
struct PixelState {
  int width, height;
  Plane* planes;  // current hypothesis
  float*
      costs;  // weighted photometric (+ geometric) cost of it, [0, 2] (+ term)
  uint32_t* masks;  // bit j: source view j was trusted when the hypothesis was
                    // accepted
  const Plane* priors;  // prior plane per pixel, distance 0 = none; null = no
                        // priors at all
  const uint8_t* visits = nullptr;  // iterations of a pass that visit the
                                    // pixel; null = all
};

}  // namespace hpm
