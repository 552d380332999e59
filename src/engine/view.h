// One reference image with everything a backend needs to estimate its depth.
#pragma once

#include "src/core/camera.h"
#include "src/image/gray_image.h"

#include <cstdint>
#include <memory>
#include <vector>

namespace hpm {

struct View {
  Camera camera;
  std::shared_ptr<const GrayImage> image;  // camera.width x camera.height
  // Geometric passes: 1/z at pixel centres, row-major, 0 = none. Null: this
  // view has no depth map and takes part photometrically only.
  std::shared_ptr<const std::vector<float>> inverse_depth;
};

struct ViewSet {
  View ref;
  std::vector<View> srcs;  // at most kMaxViews
  float depth_min,
      depth_max;        // hypotheses outside are not accepted, model units
  uint64_t random_key;  // identifies (seed, image)
};

}  // namespace hpm
