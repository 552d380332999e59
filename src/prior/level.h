// Hypotheses at a reduced scale, for building priors (paper, section 3.4).
// Level l halves the image l times.
#pragma once

#include "src/image/hypothesis_map.h"

#include <vector>

namespace hpm {

struct LevelMap {
  Camera camera;  // of the level; integer (col, row) is the centre of its pixel
  std::vector<float> depths;  // z at the pixel centre, 0 = none, row-major
  std::vector<float> costs;
};

// In each block of full-resolution pixels the one of smallest cost speaks for
// the level pixel, with its plane evaluated at the block's centre.
LevelMap MakeLevel(const HypothesisMap& map, const Camera& camera, int level);

}  // namespace hpm
