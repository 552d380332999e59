// Pictures and exact maps of a test scene.
#pragma once

#include "src/core/camera.h"
#include "tests/scenes/scene.h"

#include <cstdint>
#include <vector>

namespace hpm {

// Row-major; depth is z in the camera frame (0: the ray meets nothing), normals
// are unit, in the camera frame, toward the camera.
struct TrueMaps {
  std::vector<float> depth;
  std::vector<Vec3f> normals;
};

struct RenderedView {
  Camera camera;
  std::vector<uint8_t> grey;
  TrueMaps truth;  // at pixel centres
};

// Each grey value is the mean of supersampling^2 rays over its pixel; a ray
// that meets nothing is black.
RenderedView RenderView(const TestScene& scene,
                        int view,
                        int supersampling = 4);
std::vector<RenderedView> RenderViews(const TestScene& scene,
                                      int supersampling = 4);

// The maps for the rays through (col + offset, row + offset) in the library's
// pixel rule: 0 = pixel centres, -0.5 = the rays of COLMAP's map files.
TrueMaps RenderTrueMaps(const TestScene& scene,
                        const Camera& camera,
                        double offset);

// What the ray through (col, row) meets first.
std::optional<Hit> HitAt(const TestScene& scene,
                         const Camera& camera,
                         double col,
                         double row);

}  // namespace hpm
