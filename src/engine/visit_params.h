// The numbers of a pixel visit that follow from a problem and the method's
// parameters, the same for every backend.
#pragma once

#include "src/core/visit.h"
#include "src/engine/pass.h"
#include "src/engine/view.h"

namespace hpm {

// `geometric` is left false; a pass sets it.
VisitParams MakeVisitParams(const ViewSet& views, const MethodParams& params);

}  // namespace hpm
