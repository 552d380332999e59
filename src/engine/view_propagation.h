// View propagation (Bleyer et al., PatchMatch Stereo, BMVC 2011): planes of the
// surfaces that the sources found, carried to where they lie in the reference.
// A near surface that few views share is found in one image by chance and not
// in the next; this brings it to all that see it.
#pragma once

#include "src/base/cancel.h"
#include "src/engine/plane_evidence.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/weak_regions.h"

namespace hpm {

// Every textured pixel takes the plane that most sources found for it, where
// these are more than found its own and the images match better on that plane;
// in `regions`, without texture, images cannot tell. The costs of the map are
// then those of the planes before; touches the map. Throws Error(kInterrupted)
// once `cancel`, which may be null, is set.
void PropagateViews(const ViewSet& views,
                    const WeakRegions& regions,
                    const ScorePlanes& score,
                    const CancelToken* cancel,
                    HypothesisMap* map);

}  // namespace hpm
