// A camera at a place on the x axis that looks along z.
#pragma once

#include "src/core/camera.h"

namespace hpm {

// The focal length is 40 pixels, the principal point the middle of the image.
inline Camera ForwardCamera(int width, int height, float x) {
  return {width,
          height,
          40,
          40,
          0.5f * static_cast<float>(width - 1),
          0.5f * static_cast<float>(height - 1),
          {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
          {-x, 0, 0}};
}

}  // namespace hpm
