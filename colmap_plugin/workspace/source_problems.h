// A patch-match.cfg that lists a few references only: geometric stages and the
// filter read maps of every source, so sources that are no references
// themselves become problems, too, whose maps are not published.
#pragma once

#include "colmap_plugin/workspace/problem.h"

#include <vector>

namespace hpm {

// One per source of `problems` that is no reference there, in the order of the
// images; not for problems that cannot be computed. Their own sources are
// chosen automatically; where there are none, they are the references that list
// the image. Sources of theirs that are neither stay without maps: they match,
// but have no say on consistency.
// overview: see ReadProblems(). Throws Error(kInterrupted).
std::vector<StereoProblem> SourceProblems(
    const Workspace& workspace,
    const ModelOverview& overview,
    const std::vector<StereoProblem>& problems,
    const ProblemOptions& options,
    const LogSink& log,
    const CancelToken& cancel);

}  // namespace hpm
