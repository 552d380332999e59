// From COLMAP's camera and rotation to the library's pinhole camera at working
// size. Its centre is the origin, t zero: see Workspace::CameraAround().
#pragma once

#include "colmap_plugin/formats/sparse_model.h"
#include "colmap_plugin/workspace/image_size.h"
#include "src/core/camera.h"

#include <optional>
#include <string>

namespace hpm {

// In this order:
//  1. intrinsics are scaled to the size of the image file where it is known and
//     differs (image_undistorter before 4.1.1 shrinks files but not cameras);
//  2. K and R become float32; if a side exceeds max_image_size (<= 0: off) both
//     sides are rounded to the scale that fits and K follows, all in float32 as
//     COLMAP does;
//  3. 0.5 is subtracted from cx, cy (COLMAP's model has pixel centres at +0.5,
//     the library at integers).
// Nothing, and the reason with its remedy in `why_not`, if patch match cannot
// use the camera: not a perspective model, a distortion parameter above 1e-8 in
// size, non-finite numbers, focal length <= 0, zero quaternion, impossible
// size.
std::optional<Camera> MakeWorkingCamera(
    const SparseCamera& sparse_camera,
    const SparseImage& image,
    const std::optional<ImageSize>& file_size,
    int max_image_size,
    std::string* why_not);

}  // namespace hpm
