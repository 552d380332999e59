// The numbers of a pixel visit that follow from a problem and the method's
// parameters, the same for every backend.
#pragma once

#include "src/core/match_cost.h"
#include "src/core/visit.h"
#include "src/engine/pass.h"
#include "src/engine/view.h"

namespace hpm {

PatchShape ShapeOf(const MethodParams& params);

VisitParams MakeVisitParams(const ViewSet& views, const MethodParams& params);

// Pixels that a source position moves per unit of -1/z of the plane, about: the
// largest focal length times baseline.
float Parallax(const ViewSet& views);

// Pixels per unit of -1/z; half the views that see depth at all have more. 0
// if none does: all look from where the reference does.
float MedianParallax(const ViewSet& views);
float Parallax(const View& ref, const View& src);

// The same for a pass of this kind.
VisitParams ForPass(VisitParams visit,
                    const MethodParams& params,
                    const Pass& pass);

}  // namespace hpm
