// Pinhole camera. Inside the library integer (col, row) IS the pixel centre:
// whoever builds a Camera from a model that puts the centre of pixel (col, row)
// at (col + 0.5, row + 0.5) (COLMAP's sparse model) subtracts 0.5 from cx, cy.
#pragma once

#include "src/core/vec.h"

namespace hpm {

struct Camera {
  int width, height;     // pixels
  float fx, fy, cx, cy;  // pixels
  Mat3f R;               // cam_from_world rotation
  Vec3f t;               // cam_from_world translation, world units
};

// Point on the viewing ray of (col, row) with z = 1, camera frame.
HPM_HD Vec3f RayAt(const Camera& camera, float col, float row) {
  return {(col - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1.0f};
}

HPM_HD Vec3f WorldFromCam(const Camera& camera, const Vec3f& point) {
  return Transposed(camera.R) * (point - camera.t);
}

HPM_HD Vec3f CamFromWorld(const Camera& camera, const Vec3f& point) {
  return camera.R * point + camera.t;
}

// Camera centre in the world frame.
HPM_HD Vec3f Center(const Camera& camera) {
  return -(Transposed(camera.R) * camera.t);
}

// Camera of the image halved `level` times. The centre of its pixel x lies at
// (x + 0.5) * 2^level - 0.5; partial blocks at the right and lower border count
// as pixels.
HPM_HD Camera LevelCamera(const Camera& camera, int level) {
  const int factor = 1 << level;
  const float scale = 1.0f / static_cast<float>(factor);
  Camera result = camera;
  result.width = (camera.width + factor - 1) / factor;
  result.height = (camera.height + factor - 1) / factor;
  result.fx *= scale;
  result.fy *= scale;
  result.cx = (camera.cx + 0.5f) * scale - 0.5f;
  result.cy = (camera.cy + 0.5f) * scale - 0.5f;
  return result;
}

}  // namespace hpm
