// One reference image with everything a backend needs to estimate its depth.
#pragma once

#include "src/core/camera.h"
#include "src/image/gray_image.h"
#include "src/image/inverse_depth_map.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace hpm {

struct View {
  Camera camera;
  std::shared_ptr<const GrayImage> image;  // camera.width x camera.height
  // Geometric passes. Null: this view has no depth map and takes part
  // photometrically only.
  std::shared_ptr<const InverseDepthMap> inverse_depth;
};

struct ViewSet {
  View ref;
  std::vector<View> srcs;  // at most kMaxViews
  float depth_min,
      depth_max;        // hypotheses outside are not accepted, model units
  uint64_t random_key;  // identifies (seed, image)
};

}  // namespace hpm
