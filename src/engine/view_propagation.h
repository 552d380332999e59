// View propagation (Bleyer et al., PatchMatch Stereo, BMVC 2011): planes of the
// surfaces that the sources found, where they lie in the reference. What chance
// has found in one image, a near table of which few views see a part, so comes
// to all of them.
#pragma once

#include "src/engine/pass.h"
#include "src/engine/plane_evidence.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"

namespace hpm {

// Every textured pixel takes the plane that most sources found for it, where
// these are more than found its own and the images match better on that plane;
// where there is no texture, images cannot tell. The costs of the map are then
// those of the planes before; touches the map.
void PropagateViews(const ViewSet& views,
                    const MethodParams& params,
                    const ScorePlanes& score,
                    HypothesisMap* map);

}  // namespace hpm
