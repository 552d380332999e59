// Plane hypothesis n.X + d = 0 in the reference camera frame; unit normal that
// faces the camera (n.ray < 0), hence d > 0 for points in front of it.
#pragma once

#include "src/core/camera.h"

namespace hpm {

struct Plane {
  Vec3f normal;
  float distance;
};

// Plane through the point of depth z on a ray (x, y, 1) of the camera frame.
HPM_HD Plane PlaneOnRay(const Vec3f& ray, float depth, const Vec3f& normal) {
  return {normal, -depth * Dot(normal, ray)};
}

// The same on the ray of (col, row).
HPM_HD Plane PlaneFromDepth(const Camera& camera,
                            float col,
                            float row,
                            float depth,
                            const Vec3f& normal) {
  return PlaneOnRay(RayAt(camera, col, row), depth, normal);
}

// Depth z of the plane on the ray; infinite or negative where the ray runs
// along the plane or meets it behind the camera.
HPM_HD float DepthOnRay(const Plane& plane, const Vec3f& ray) {
  return -plane.distance / Dot(plane.normal, ray);
}

// The same on the ray of (col, row).
HPM_HD float DepthAt(const Camera& camera,
                     const Plane& plane,
                     float col,
                     float row) {
  return DepthOnRay(plane, RayAt(camera, col, row));
}

}  // namespace hpm
