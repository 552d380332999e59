// What a kernel of the CUDA backend does, as loops on the host.
#pragma once

#include "cuda/warp.h"
#include "src/core/sweep.h"
#include "src/gpu/device_problem.h"

#include <cstdint>
#include <vector>

namespace hpm {

enum class EmulatedCost {
  kCore,     // the matching cost of src/core
  kQuad,     // the card's, exact interpolation
  kTexture,  // the card's, interpolation of the texture unit
};

// Visits the pixels of the band; returns the number of matching costs.
// `problem.params.geometric` is that of the sweep, all views have texels.
uint64_t RunBand(EmulatedCost cost,
                 const DeviceProblem& problem,
                 const Sweep& sweep,
                 const PixelState& state,
                 uint32_t* consistent,
                 const Band& band);

// The cost of a plane from all views; adds the matching costs to *count.
float ScoreOnHost(EmulatedCost cost,
                  const DeviceProblem& problem,
                  const PixelPlane& at,
                  uint64_t* count);

// The texels of the first width x height pixels of a grey image.
std::vector<uint32_t> TexelsOf(const uint8_t* grey,
                               int row_length,
                               int width,
                               int height);

}  // namespace hpm
