// How NVIDIA's cards run lanes together.
#pragma once

#include "src/gpu/pixel_tiles.h"

namespace hpm {

constexpr int kWarpSize = 32;
using Band = TileBand<kWarpSize>;

}  // namespace hpm
