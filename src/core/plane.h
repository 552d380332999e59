// Plane hypothesis n.X + d = 0 in the reference camera frame; unit normal that
// faces the camera (n.ray < 0), hence d > 0 for points in front of it.
#pragma once

#include "src/core/camera.h"

namespace hpm {

struct Plane {
  Vec3f normal;
  float distance;
};

// Plane through the point of depth z on the ray of (col, row).
HPM_HD Plane PlaneFromDepth(const Camera& camera,
                            float col,
                            float row,
                            float depth,
                            const Vec3f& normal) {
  return {normal, -depth * Dot(normal, RayAt(camera, col, row))};
}

// Depth z of the plane on the ray of (col, row); infinite or negative where the
// ray runs along the plane or meets it behind the camera.
HPM_HD float DepthAt(const Camera& camera,
                     const Plane& plane,
                     float col,
                     float row) {
  return -plane.distance / Dot(plane.normal, RayAt(camera, col, row));
}

}  // namespace hpm
