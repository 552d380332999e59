// In which order problems are worked off: neighbours share images, so that what
// was read for one is still in memory for the next.
#pragma once

#include "colmap_plugin/workspace/problem.h"

#include <cstddef>
#include <vector>

namespace hpm {

// Orders the problems from `begin` on; those before stay, and the order goes on
// from them. A chain: after each problem the one that shares most images with
// it, among equals the one that shares most with the last few, among these the
// first; where nothing is left that shares any, the one that goes on from the
// problem before, and so on; where nothing is left at all, the first of the
// rest. It goes by wanted_sources, so that it is the same for all who read
// the same cfg and model. Takes time in proportion to the number of problems.
void OrderByOverlap(std::vector<StereoProblem>* problems, size_t begin = 0);

}  // namespace hpm
