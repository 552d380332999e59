#include "tests/scenes/render.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace hpm {
namespace {

using RowMajor3f = Eigen::Matrix<float, 3, 3, Eigen::RowMajor>;

Eigen::Matrix3d Rotation(const Camera& camera) {
  return Eigen::Map<const RowMajor3f>(camera.R.m).cast<double>();
}

Eigen::Vector3d Translation(const Camera& camera) {
  return {camera.t.x, camera.t.y, camera.t.z};
}

// Of mean 0 and variance 1; the standard distributions differ between
// libraries.
float Normal(std::mt19937* generator) {
  float sum = 0;
  for (int i = 0; i < 12; ++i)
    sum += static_cast<float>((*generator)()) / 4294967296.0f;
  return sum - 6;
}

}  // namespace

std::optional<Hit> HitAt(const TestScene& scene,
                         const Camera& camera,
                         double col,
                         double row) {
  const Eigen::Matrix3d world_from_cam = Rotation(camera).transpose();
  const Eigen::Vector3d ray(
      (col - camera.cx) / camera.fx, (row - camera.cy) / camera.fy, 1);
  return Intersect(scene.surfaces,
                   -world_from_cam * Translation(camera),
                   world_from_cam * ray);
}

TrueMaps RenderTrueMaps(const TestScene& scene,
                        const Camera& camera,
                        double offset) {
  const Eigen::Matrix3d rotation = Rotation(camera);
  TrueMaps maps;
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const std::optional<Hit> hit =
          HitAt(scene, camera, col + offset, row + offset);
      // The ray has z = 1 in the camera frame, so its parameter is the depth.
      maps.depth.push_back(hit ? static_cast<float>(hit->t) : 0);
      Eigen::Vector3f normal = Eigen::Vector3f::Zero();
      if (hit) normal = (rotation * hit->normal).cast<float>();
      maps.normals.push_back({normal.x(), normal.y(), normal.z()});
    }
  }
  return maps;
}

RenderedView RenderView(const TestScene& scene, int view, int supersampling) {
  RenderedView result;
  result.camera = scene.cameras[view];
  const Camera& camera = result.camera;
  result.truth = RenderTrueMaps(scene, camera, 0);
  result.grey.reserve(result.truth.depth.size());
  std::mt19937 generator(view);
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      float sum = 0;
      for (int sample = 0; sample < supersampling * supersampling; ++sample) {
        const double x = (sample % supersampling + 0.5) / supersampling - 0.5;
        const double y = (sample / supersampling + 0.5) / supersampling - 0.5;
        const std::optional<Hit> hit = HitAt(scene, camera, col + x, row + y);
        if (hit) sum += scene.texture.Grey(hit->point.cast<float>());
      }
      const float mean =
          sum / static_cast<float>(supersampling * supersampling) +
          scene.noise * Normal(&generator);
      result.grey.push_back(
          static_cast<uint8_t>(std::lround(std::clamp(mean, 0.0f, 255.0f))));
    }
  }
  return result;
}

std::vector<RenderedView> RenderViews(const TestScene& scene,
                                      int supersampling) {
  std::vector<RenderedView> views;
  for (size_t i = 0; i < scene.cameras.size(); ++i) {
    views.push_back(RenderView(scene, static_cast<int>(i), supersampling));
  }
  return views;
}

}  // namespace hpm
