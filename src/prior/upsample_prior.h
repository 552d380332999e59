// Joint bilateral upsampling of a prior to full resolution (HPM-MVS
// section 3.3; specification section 8, with its corrections: planes are
// evaluated at the pixel, so slanted surfaces stay exact; missing taps are
// skipped; the guide is read where the tap lies).
#pragma once

#include "src/image/gray_image.h"
#include "src/prior/planar_prior.h"

#include <vector>

namespace hpm {

// planes: one per pixel of LevelCamera(camera, level). Result: one per pixel of
// `camera`, distance 0 = none.
std::vector<Plane> UpsamplePrior(const std::vector<Plane>& planes,
                                 int level,
                                 const Camera& camera,
                                 const GrayImage& guide,
                                 const PriorRange& range);

}  // namespace hpm
