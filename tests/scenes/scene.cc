#include "tests/scenes/scene.h"

#include "src/base/error.h"

#include <cmath>
#include <utility>

#include <Eigen/Geometry>

namespace hpm {
namespace {

using Eigen::Vector3d;

constexpr double kDistance =
    5;  // world units, camera to the middle of the scene
constexpr double kArcDegrees =
    30;  // so that neighbours see the scene from some 4 degrees apart

double Focal(const SceneOptions& options) { return 1.2 * options.width; }

// Waves of 4 to 16 pixels at the middle of the scene.
TextureOptions TextureFor(const SceneOptions& options) {
  const double pixel = kDistance / Focal(options);
  TextureOptions texture;
  texture.shortest_wave = 4 * pixel;
  texture.longest_wave = 16 * pixel;
  return texture;
}

TestScene Assemble(const SceneOptions& options,
                   std::vector<Surface> surfaces,
                   const TextureOptions& texture) {
  return {std::move(surfaces),
          Texture(texture),
          ArcCameras(options, kDistance, kArcDegrees)};
}

// The view-th camera; x lies level.
Camera MakeCamera(const SceneOptions& options,
                  int view,
                  const Vector3d& center,
                  const Vector3d& forward) {
  const Vector3d right = Vector3d::UnitY().cross(forward).normalized();
  Eigen::Matrix3d rotation;
  rotation << right.transpose(), forward.cross(right).transpose(),
      forward.transpose();
  if (!options.quarter_turns.empty()) {
    const int turns =
        options.quarter_turns[view % options.quarter_turns.size()];
    rotation =
        Eigen::AngleAxisd(turns * M_PI / 2, Vector3d::UnitZ()) * rotation;
  }
  const Vector3d translation = -rotation * center;

  Camera camera;
  camera.width = options.width;
  camera.height = options.height;
  camera.fx = camera.fy = static_cast<float>(Focal(options));
  camera.cx = 0.5f * static_cast<float>(options.width) - 0.5f;
  camera.cy = 0.5f * static_cast<float>(options.height) - 0.5f;
  for (int k = 0; k < 9; ++k)
    camera.R.m[k] = static_cast<float>(rotation(k / 3, k % 3));
  camera.t = {static_cast<float>(translation.x()),
              static_cast<float>(translation.y()),
              static_cast<float>(translation.z())};
  return camera;
}

using Maker = TestScene (*)(const SceneOptions&);

const std::vector<std::pair<std::string, Maker>>& Makers() {
  static const std::vector<std::pair<std::string, Maker>> makers = {
      {"tilted_plane", MakeTiltedPlane},
      {"depth_step", MakeDepthStep},
      {"sphere", MakeSphere},
      {"low_texture_wall", MakeLowTextureWall},
      {"corridor", MakeCorridor}};
  return makers;
}

}  // namespace

std::vector<Camera> ArcCameras(const SceneOptions& options,
                               double distance,
                               double arc_degrees) {
  std::vector<Camera> cameras;
  for (int i = 0; i < options.num_views; ++i) {
    const double share =
        options.num_views > 1 ? i / (options.num_views - 1.0) : 0.5;
    const double azimuth = arc_degrees * (share - 0.5) * M_PI / 180;
    const double elevation =
        (i % 2 == 0 ? 1 : -1) * 0.2 * arc_degrees * M_PI / 180;
    const Vector3d center =
        distance * Vector3d(std::sin(azimuth) * std::cos(elevation),
                            std::sin(elevation),
                            -std::cos(azimuth) * std::cos(elevation));
    cameras.push_back(MakeCamera(options, i, center, -center.normalized()));
  }
  return cameras;
}

TestScene MakeTiltedPlane(const SceneOptions& options) {
  return Assemble(
      options,
      {PlaneSurface{
          Vector3d::Zero(), Vector3d(0.3, -0.4, -1).normalized(), {}}},
      TextureFor(options));
}

TestScene MakeDepthStep(const SceneOptions& options) {
  const Vector3d toward = -Vector3d::UnitZ();
  return Assemble(
      options,
      {PlaneSurface{Vector3d(0, 0, -0.4), toward, Vector3d::UnitX()},
       PlaneSurface{Vector3d(0, 0, 0.4), toward, {}}},
      TextureFor(options));
}

TestScene MakeSphere(const SceneOptions& options) {
  return Assemble(
      options,
      {SphereSurface{Vector3d(0, 0, 0.2), 1.0},
       PlaneSurface{
           Vector3d(0, 0, 1), Vector3d(0.1, 0.2, -1).normalized(), {}}},
      TextureFor(options));
}

TestScene MakeLowTextureWall(const SceneOptions& options) {
  TextureOptions texture = TextureFor(options);
  const double pixel = kDistance / Focal(options);
  texture.disc_spacing = 40 * pixel;
  texture.disc_radius = 10 * pixel;
  texture.plain_contrast = 0.5;
  return Assemble(
      options,
      {PlaneSurface{
          Vector3d::Zero(), Vector3d(-0.4, 0.2, -1).normalized(), {}}},
      texture);
}

TestScene MakeRoom(const SceneOptions& options) {
  TextureOptions texture = TextureFor(options);
  const double pixel = kDistance / Focal(options);
  texture.disc_beyond = kBackWall;
  texture.disc_spacing = 40 * pixel;
  texture.disc_radius = 6 * pixel;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(),
                 z = Vector3d::UnitZ();
  return Assemble(options,
                  {PlaneSurface{1.02 * kBackWall * z, -z, {}},
                   PlaneSurface{-1.5 * x, x, {}},
                   PlaneSurface{1.5 * x, -x, {}},
                   PlaneSurface{-1.1 * y, y, {}},
                   PlaneSurface{1.1 * y, -y, {}},
                   SphereSurface{Vector3d(0.3, -0.1, -0.4), 0.35}},
                  texture);
}

TestScene MakeCorridor(const SceneOptions& options) {
  // As of a photograph indoors. Without it the faintest texture would do.
  constexpr float kCorridorNoise = 2.5f;
  TextureOptions texture = TextureFor(options);
  texture.balls = true;
  texture.disc_spacing = 1.2;
  texture.disc_radius = 0.25;
  texture.plain_contrast = 0.5;
  const Vector3d x = Vector3d::UnitX(), y = Vector3d::UnitY(),
                 z = Vector3d::UnitZ();
  TestScene scene = {{PlaneSurface{8 * z, -z, {}},
                      PlaneSurface{-1.2 * x, x, {}},
                      PlaneSurface{1.2 * x, -x, {}},
                      PlaneSurface{-1.3 * y, y, {}},
                      PlaneSurface{1.3 * y, -y, {}}},
                     Texture(texture),
                     {},
                     kCorridorNoise};
  for (int i = 0; i < options.num_views; ++i) {
    const Vector3d center(0.35 * std::sin(1.7 * i),
                          0.15 * std::cos(2.1 * i) - 0.15,
                          0.45 * i - 8);
    const Vector3d ahead(0.3 * std::sin(0.9 * i), 0, 10);
    scene.cameras.push_back(MakeCamera(options, i, center, ahead.normalized()));
  }
  return scene;
}

const std::vector<std::string>& SceneNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const auto& maker : Makers()) list.push_back(maker.first);
    return list;
  }();
  return names;
}

TestScene MakeScene(const std::string& name, const SceneOptions& options) {
  std::string known;
  for (const auto& [maker_name, make] : Makers()) {
    if (maker_name == name) return make(options);
    known += " " + maker_name;
  }
  throw Error(ErrorCode::kUsage,
              "no scene is named '" + name + "'; there are:" + known);
}

}  // namespace hpm
