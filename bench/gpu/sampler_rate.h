// How many image samples per second a card delivers in the pattern of the
// matching cost, for each way of reading: the bound of everything else.
#pragma once

#include "src/engine/view.h"
#include "src/gpu/samplers.h"

namespace hpm {

// Samples per second. Every thread walks windows of 6x6 samples, two pixels
// apart, at sub-pixel positions; the windows of a warp lie `spread` pixels
// apart (2: as converged neighbours, more: as random hypotheses).
double MeasureSampleRate(const ViewSet& views,
                         ImageFormat format,
                         int log_tile_width,
                         float spread);

}  // namespace hpm
