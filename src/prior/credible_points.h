// Credible points: pixels whose matching cost is small enough to span a prior
// (paper, section 3.3, equation of I_cred; the cells are its authors' code's).
#pragma once

#include "src/prior/level.h"

#include <vector>

namespace hpm {

struct CrediblePoint {
  int col, row;    // level pixel
  Vec3f position;  // reference camera frame, model units
};

// In each cell of 5x5 level pixels the one of smallest cost, if that is below
// `max_cost`. Row-major over cells.
std::vector<CrediblePoint> FindCrediblePoints(const LevelMap& level,
                                              float max_cost);

}  // namespace hpm
