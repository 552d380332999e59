// Triangles for what no plane explains. A plane is mined from points that views
// agree on; in a corridor seen along its axis nothing plain is found by chance
// in several views, so nothing can be mined. Triangles of pixels that match
// well (paper, section 3.3) need no agreement, and reach over such walls. They
// also join a lamp in front to the wall behind, and bend a wall that is half
// found into facets; so they are offered only where nothing better is known, as
// proposals, early enough for views to contradict.
#pragma once

#include "src/engine/plane_evidence.h"
#include "src/engine/view.h"
#include "src/image/hypothesis_map.h"
#include "src/prior/weak_regions.h"

#include <vector>

namespace hpm {

// Pixels of the regions without a prior take that of the triangle they lie in,
// and start from it: what they have was found by chance, and a proposal must
// match better than chance to be taken. map->priors has a plane or none for
// every pixel. `agreement` is that of MinedRegions: regions on half of which
// the views agree wait for the plane that the next pass mines there. Outside
// the triangles there is none: the paper's fill-in, the plane of the nearest
// points, carries a table over the backdrop beside it.
void OfferTriangles(const ViewSet& views,
                    const WeakRegions& regions,
                    const std::vector<float>& agreement,
                    const ScorePlanes& score,
                    HypothesisMap* map);

}  // namespace hpm
