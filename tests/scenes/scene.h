// Closed-form scenes for tests: surfaces, texture and cameras whose true depth
// and normals are known exactly. World frame: x right, y down, z away from the
// cameras, the middle of each scene near the origin.
#pragma once

#include "src/core/camera.h"
#include "tests/scenes/surface.h"
#include "tests/scenes/texture.h"

#include <string>
#include <vector>

namespace hpm {

struct SceneOptions {
  int num_views = 8;
  int width = 160;  // pixels
  int height = 120;
  // Roll of camera i about its optical axis, quarter turns; shorter than
  // num_views: repeats. Empty: none.
  std::vector<int> quarter_turns;
};

struct TestScene {
  std::vector<Surface> surfaces;
  Texture texture;
  std::vector<Camera> cameras;
  // Of every pixel on its own, standard deviation, grey values.
  float noise = 0;
};

// Cameras on an arc of `arc_degrees` about the y axis at `distance` from the
// origin, alternately above and below the horizon, all looking at the origin.
std::vector<Camera> ArcCameras(const SceneOptions& options,
                               double distance,
                               double arc_degrees);

TestScene MakeTiltedPlane(const SceneOptions& options);
// A half-plane in front of a plane.
TestScene MakeDepthStep(const SceneOptions& options);
TestScene MakeSphere(const SceneOptions& options);
// A tilted wall that is plain but for discs of texture.
TestScene MakeLowTextureWall(const SceneOptions& options);
// Looks into a box whose walls, floor and ceiling have texture; the back wall,
// at world z >= kBackWall, is plain but for discs, and a ball hangs before it.
constexpr double kBackWall = 0.8;
TestScene MakeRoom(const SceneOptions& options);

// Along a corridor of plain walls, floor and ceiling with patches of texture;
// the cameras walk down its middle, so that views see little parallax ahead.
TestScene MakeCorridor(const SceneOptions& options);

const std::vector<std::string>& SceneNames();
// One of SceneNames(); throws Error(kUsage) for any other name.
TestScene MakeScene(const std::string& name, const SceneOptions& options);

}  // namespace hpm
