// Joint bilateral upsampling of a prior to full resolution, see
// src/core/upsample_plane.h.
#pragma once

#include "src/image/gray_image.h"
#include "src/prior/planar_prior.h"

#include <vector>

namespace hpm {

// planes: one per pixel of LevelCamera(camera, level). Result: one per pixel of
// `camera`, distance 0 = none, in the memory it has.
void UpsamplePrior(const std::vector<Plane>& planes,
                   int level,
                   const Camera& camera,
                   const GrayImage& guide,
                   const PriorRange& range,
                   std::vector<Plane>* result);

}  // namespace hpm
