// Images of more than 8 bits a sample: 12 bits in 16, thermal counts, floating
// point. All are stretched alike, since brightness is compared across them.
#pragma once

#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/controller/stages.h"
#include "colmap_plugin/workspace/workspace.h"
#include "src/base/cancel.h"

namespace hpm {

// The grey values that become black and white: from the darkest to the
// brightest of all usable deep images of the model (each without its extreme
// thousandths), whichever of them this run computes; said in the log. Nothing
// if there are no deep images, or if 16 bits lose no more than one of eight
// when they are simply cut: then they are, as COLMAP does.
//
// Each image is decoded once for that; what was found is kept in the state
// folder, by their contents, if `access` lets files be changed.
std::optional<GreyRange> FindDeepRange(const Workspace& workspace,
                                       ImageContents* contents,
                                       const LogSink& log,
                                       const CancelToken& cancel,
                                       PlanAccess access = PlanAccess::kRun);

}  // namespace hpm
