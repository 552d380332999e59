// Draws a point cloud as seen by a camera.
#pragma once

#include "bench/eval/ply.h"
#include "src/core/camera.h"

#include <opencv2/core.hpp>

namespace hpm {

// BGR picture of camera.width x camera.height on white. Each point is a square
// of `point_size` pixels, the nearest in front; points without colour are grey.
cv::Mat SplatCloud(const PointCloud& cloud,
                   const Camera& camera,
                   int point_size);

}  // namespace hpm
