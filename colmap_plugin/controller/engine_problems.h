// From the workspace's problems to the engine's.
#pragma once

#include "colmap_plugin/workspace/problem.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/engine/problem.h"

#include <vector>

namespace hpm {

// In the same order; those that cannot be computed have no sources.
std::vector<Problem> EngineProblems(const Workspace& workspace,
                                    const std::vector<StereoProblem>& problems,
                                    int random_seed);

}  // namespace hpm
