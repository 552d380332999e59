// A tilted plane seen by one camera, as hypotheses of equal cost.
#pragma once

#include "src/image/hypothesis_map.h"

namespace hpm {

inline Camera PriorCamera(int width, int height) {
  return {width,
          height,
          0.9f * static_cast<float>(width),
          0.8f * static_cast<float>(width),
          0.48f * static_cast<float>(width),
          0.53f * static_cast<float>(height),
          {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
          {0, 0, 0}};
}

inline Plane TiltedPlane() { return {Normalized({0.3f, -0.4f, -1.0f}), 4.0f}; }

inline HypothesisMap PlaneMap(const Camera& camera,
                              const Plane& plane,
                              float cost) {
  HypothesisMap map(camera.width, camera.height);
  map.planes.assign(map.planes.size(), plane);
  map.costs.assign(map.costs.size(), cost);
  return map;
}

// Depth of the plane at a pixel centre relative to that of another plane, minus
// one.
inline float DepthDifference(
    const Camera& camera, const Plane& a, const Plane& b, int col, int row) {
  const float x = static_cast<float>(col), y = static_cast<float>(row);
  return DepthAt(camera, a, x, y) / DepthAt(camera, b, x, y) - 1;
}

}  // namespace hpm
