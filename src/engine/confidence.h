// How far a finished map can be trusted, pixel by pixel.
#pragma once

#include "src/engine/needed_views.h"
#include "src/image/hypothesis_map.h"

#include <cstdint>
#include <vector>

namespace hpm {

// Per pixel the probability, 0..1, that its depth is within 1 % of the truth;
// row-major as the map. Told by how many sources confirm the pixel, which share
// of those that see it they are, its matching cost, how far the views lie
// apart, and whether a plane explains its region. Calibrated on rendered scenes
// and on photographs with measured depth (docs/confidence.md has the diagram
// and the command).
//
// consistent: bit j is set where source j confirms the pixel.
std::vector<float> Confidence(const ViewSet& views,
                              const NeededViews& needed,
                              const HypothesisMap& map,
                              const std::vector<uint32_t>& consistent);

}  // namespace hpm
