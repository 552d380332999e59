// Cameras for evaluation, straight from the sparse model.
#pragma once

#include "colmap_plugin/formats/sparse_model.h"
#include "src/core/camera.h"

namespace hpm {

// The camera of `image` scaled to a map or picture of width x height pixels,
// with the model's own principal point: RayAt(col + 0.5, row + 0.5) runs
// through the centre of pixel (col, row), RayAt(col, row) is the ray of
// COLMAP's dense maps. Throws Error(kBadInput) for cameras that are not PINHOLE
// or SIMPLE_PINHOLE.
Camera ModelCamera(const SparseModel& model,
                   const SparseImage& image,
                   int width,
                   int height);

}  // namespace hpm
