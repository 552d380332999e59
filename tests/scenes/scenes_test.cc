#include "src/base/error.h"
#include "src/core/plane.h"
#include "tests/scenes/render.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

SceneOptions SmallOptions() {
  SceneOptions options;
  options.num_views = 4;
  options.width = 80;
  options.height = 60;
  return options;
}

struct Pixel {
  float col, row, depth;
};

Pixel Project(const Camera& camera, const Vec3f& world) {
  const Vec3f p = CamFromWorld(camera, world);
  return {camera.fx * p.x / p.z + camera.cx,
          camera.fy * p.y / p.z + camera.cy,
          p.z};
}

Vec3f PointAt(const RenderedView& view, int col, int row) {
  const float depth =
      view.truth.depth[static_cast<size_t>(row) * view.camera.width + col];
  return WorldFromCam(
      view.camera,
      depth *
          RayAt(view.camera, static_cast<float>(col), static_cast<float>(row)));
}

bool Inside(const Camera& camera, const Pixel& p) {
  return p.depth > 0 && p.col >= 0 && p.col <= camera.width - 1 && p.row >= 0 &&
         p.row <= camera.height - 1;
}

float Bilinear(const RenderedView& view, float col, float row) {
  const int x = std::min(static_cast<int>(col), view.camera.width - 2);
  const int y = std::min(static_cast<int>(row), view.camera.height - 2);
  const float a = col - static_cast<float>(x);
  const float b = row - static_cast<float>(y);
  const uint8_t* at =
      &view.grey[static_cast<size_t>(y) * view.camera.width + x];
  const int below = view.camera.width;
  return (1 - b) * ((1 - a) * at[0] + a * at[1]) +
         b * ((1 - a) * at[below] + a * at[below + 1]);
}

// Standard deviation of the grey values around a pixel.
double Deviation(const RenderedView& view, int col, int row, int radius) {
  double sum = 0, squares = 0;
  int count = 0;
  for (int y = row - radius; y <= row + radius; ++y) {
    for (int x = col - radius; x <= col + radius; ++x) {
      const double g =
          view.grey[static_cast<size_t>(y) * view.camera.width + x];
      sum += g;
      squares += g * g;
      ++count;
    }
  }
  return std::sqrt(std::max(0.0, squares / count - sum * sum / count / count));
}

class EveryScene : public testing::TestWithParam<std::string> {};

TEST_P(EveryScene,
       TrueDepthReprojectsIntoTheOtherViewsWithinAThousandthOfAPixel) {
  SceneOptions options = SmallOptions();
  options.quarter_turns = {0, 1, 2, 3};
  const TestScene scene = MakeScene(GetParam(), options);
  const std::vector<RenderedView> views = RenderViews(scene, 1);
  int num_checked = 0;
  for (const RenderedView& from : views) {
    for (const RenderedView& to : views) {
      for (int row = 0; row < from.camera.height; row += 5) {
        for (int col = 0; col < from.camera.width; col += 5) {
          const Pixel there = Project(to.camera, PointAt(from, col, row));
          if (!Inside(to.camera, there)) continue;
          const auto hit = HitAt(scene, to.camera, there.col, there.row);
          ASSERT_TRUE(hit);
          if (hit->t < 0.999 * there.depth)
            continue;  // something stands before it
          const Eigen::Vector3f p = hit->point.cast<float>();
          const Pixel back = Project(from.camera, {p.x(), p.y(), p.z()});
          EXPECT_NEAR(back.col, col, 1e-3);
          EXPECT_NEAR(back.row, row, 1e-3);
          ++num_checked;
        }
      }
    }
  }
  EXPECT_GT(num_checked, 1000);
}

TEST_P(EveryScene, NormalsAreUnitAndFaceTheCamera) {
  const TestScene scene = MakeScene(GetParam(), SmallOptions());
  for (const Camera& camera : scene.cameras) {
    const TrueMaps maps = RenderTrueMaps(scene, camera, 0);
    for (int row = 0; row < camera.height; ++row) {
      for (int col = 0; col < camera.width; ++col) {
        const size_t at = static_cast<size_t>(row) * camera.width + col;
        ASSERT_GT(maps.depth[at], 0);
        EXPECT_NEAR(Norm(maps.normals[at]), 1, 1e-5);
        EXPECT_LT(
            Dot(maps.normals[at],
                RayAt(
                    camera, static_cast<float>(col), static_cast<float>(row))),
            0);
      }
    }
  }
}

// The plane through a pixel's depth and normal predicts its neighbour's depth,
// to first order; a normal in the wrong frame or of the wrong surface does not.
TEST_P(EveryScene, NormalsAreTheSlopeOfTheDepth) {
  const TestScene scene = MakeScene(GetParam(), SmallOptions());
  const Camera& camera = scene.cameras[0];
  const TrueMaps maps = RenderTrueMaps(scene, camera, 0);
  int num_agreeing = 0;
  int num_pixels = 0;
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col + 1 < camera.width; ++col) {
      const size_t at = static_cast<size_t>(row) * camera.width + col;
      const auto x = static_cast<float>(col);
      const auto y = static_cast<float>(row);
      const Plane plane =
          PlaneFromDepth(camera, x, y, maps.depth[at], maps.normals[at]);
      const float predicted = DepthAt(camera, plane, x + 1, y);
      ++num_pixels;
      if (std::abs(predicted - maps.depth[at + 1]) < 2e-3f * predicted)
        ++num_agreeing;
    }
  }
  EXPECT_GT(num_agreeing, 0.9 * num_pixels);
}

TEST_P(EveryScene, TextureSticksToTheSurface) {
  TestScene scene = MakeScene(GetParam(), SmallOptions());
  scene.noise = 0;
  const RenderedView from = RenderView(scene, 1);
  const RenderedView to = RenderView(scene, 2);
  double difference = 0, shifted_difference = 0;
  int count = 0;
  for (int row = 8; row < from.camera.height - 8; ++row) {
    for (int col = 8; col < from.camera.width - 8; ++col) {
      const Pixel there = Project(to.camera, PointAt(from, col, row));
      if (there.col < 4 || there.row < 4 || there.col > to.camera.width - 5 ||
          there.row > to.camera.height - 5) {
        continue;
      }
      const float grey =
          from.grey[static_cast<size_t>(row) * from.camera.width + col];
      difference += std::abs(grey - Bilinear(to, there.col, there.row));
      shifted_difference +=
          std::abs(grey - Bilinear(to, there.col + 3, there.row));
      ++count;
    }
  }
  ASSERT_GT(count, 500);
  EXPECT_LT(difference / count, 8);
  EXPECT_LT(difference, 0.5 * shifted_difference);
}

INSTANTIATE_TEST_SUITE_P(Scenes,
                         EveryScene,
                         testing::ValuesIn(SceneNames()),
                         [](const auto& scene) { return scene.param; });

TEST(Scenes, TexturedScenesHaveContrastInEveryWindow) {
  for (const char* name : {"tilted_plane", "depth_step", "sphere"}) {
    const TestScene scene = MakeScene(name, SceneOptions());
    const RenderedView view = RenderView(scene, 3);
    for (int row = 5; row < view.camera.height - 5; ++row) {
      for (int col = 5; col < view.camera.width - 5; ++col) {
        ASSERT_GT(Deviation(view, col, row, 5), 5)
            << name << " " << col << " " << row;
      }
    }
  }
}

TEST(Scenes, LowTextureWallIsPlainOverMoreThanAThirdAndTexturedInDiscs) {
  const TestScene scene = MakeLowTextureWall(SceneOptions());
  const RenderedView view = RenderView(scene, 3);
  int num_plain = 0, num_textured = 0, num_windows = 0;
  for (int row = 5; row < view.camera.height - 5; ++row) {
    for (int col = 5; col < view.camera.width - 5; ++col) {
      const double deviation = Deviation(view, col, row, 5);
      ++num_windows;
      if (deviation < 2) ++num_plain;
      if (deviation > 15) ++num_textured;
    }
  }
  EXPECT_GT(num_plain, num_windows / 3);
  EXPECT_GT(num_textured, num_windows / 10);
}

TEST(Scenes, NoiseIsOfEveryPixelOnItsOwn) {
  TestScene scene = MakeTiltedPlane(SceneOptions());
  const RenderedView clean = RenderView(scene, 0);
  scene.noise = 2;
  const RenderedView noisy = RenderView(scene, 0);
  double sum = 0, square = 0, neighbours = 0;
  const size_t size = clean.grey.size();
  for (size_t at = 0; at + 1 < size; ++at) {
    const double here = noisy.grey[at] - clean.grey[at];
    sum += here;
    square += here * here;
    neighbours += here * (noisy.grey[at + 1] - clean.grey[at + 1]);
  }
  EXPECT_NEAR(sum / size, 0, 0.1);
  EXPECT_NEAR(std::sqrt(square / size), 2, 0.2);
  EXPECT_NEAR(neighbours / square, 0, 0.1);
}

TEST(Scenes, QuarterTurnRotatesThePicture) {
  SceneOptions options;
  options.num_views = 1;
  options.width = options.height = 40;
  const RenderedView upright = RenderView(MakeTiltedPlane(options), 0);
  options.quarter_turns = {1};
  const RenderedView turned = RenderView(MakeTiltedPlane(options), 0);
  for (int row = 0; row < 40; ++row) {
    for (int col = 0; col < 40; ++col) {
      EXPECT_NEAR(turned.grey[static_cast<size_t>(col) * 40 + (39 - row)],
                  upright.grey[static_cast<size_t>(row) * 40 + col],
                  1);
    }
  }
}

TEST(Scenes, UnknownNameIsAUsageErrorThatListsTheNames) {
  try {
    MakeScene("castle", SceneOptions());
    FAIL() << "no error";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    EXPECT_NE(std::string(error.what()).find("tilted_plane"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace hpm
