// Sizes and contents that leave nothing to match: every method must end with
// sound maps.
#include "src/cpu/cpu_backend.h"
#include "tests/engine/estimate.h"
#include "tests/engine/forward_camera.h"

#include <functional>
#include <memory>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>

namespace hpm {
namespace {

using Paint = std::function<uint8_t(int view, int col, int row)>;

uint8_t Noise(int view, int col, int row) {
  std::mt19937 random(1000000 * view + 1000 * row + col);
  return static_cast<uint8_t>(random());
}

// Cameras side by side that look along +z.
std::vector<RenderedView> PaintedViews(int num_views,
                                       int width,
                                       int height,
                                       const Paint& paint) {
  std::vector<RenderedView> views;
  for (int i = 0; i < num_views; ++i) {
    RenderedView view;
    view.camera = ForwardCamera(width, height, 0.3f * static_cast<float>(i));
    for (int row = 0; row < height; ++row) {
      for (int col = 0; col < width; ++col) {
        view.grey.push_back(paint(i, col, row));
      }
    }
    view.truth.depth.assign(view.grey.size(), 4.0f);
    views.push_back(std::move(view));
  }
  return views;
}

class EveryMethod : public testing::TestWithParam<std::string> {
 protected:
  void ExpectSoundMaps(int num_views,
                       int width,
                       int height,
                       const Paint& paint,
                       int num_levels = 1) {
    SCOPED_TRACE(std::to_string(width) + "x" + std::to_string(height));
    const auto views = PaintedViews(num_views, width, height, paint);
    ScheduleOptions options;
    options.method = GetParam();
    options.num_iterations = 2;
    options.num_geom_iterations = 1;
    options.num_geom_passes = 1;
    options.num_levels = num_levels;
    const auto maps = EstimateScene(&workers_, views, options, num_views);
    for (int i = 0; i < num_views; ++i) {
      ExpectSound(maps[i], views[i].camera);
    }
  }

  WorkerPool workers_{MakeCpuBackend("auto", 2)};
};
INSTANTIATE_TEST_SUITE_P(Methods,
                         EveryMethod,
                         testing::Values("acmh", "nesp", "hpm", "hpm_plus"),
                         [](const auto& test) { return test.param; });

TEST_P(EveryMethod, TinyAndNarrowImagesGiveSoundMaps) {
  ExpectSoundMaps(3, 1, 1, Noise);
  ExpectSoundMaps(3, 2, 1, Noise);
  ExpectSoundMaps(3, 1, 33, Noise);
  ExpectSoundMaps(3, 33, 1, Noise);
  ExpectSoundMaps(3, 5, 5, Noise);
  ExpectSoundMaps(3, 7, 120, Noise);
}

TEST_P(EveryMethod, PriorsOfTinyLevelsGiveSoundMaps) {
  ExpectSoundMaps(3, 1, 1, Noise, 3);
  ExpectSoundMaps(3, 3, 33, Noise, 3);
  ExpectSoundMaps(3, 13, 11, Noise, 2);
}

TEST_P(EveryMethod, WidthsBetweenVectorsGiveSoundMaps) {
  for (const int width : {3, 15, 17, 31}) ExpectSoundMaps(3, width, 9, Noise);
}

TEST_P(EveryMethod, OneSourceIsEnough) { ExpectSoundMaps(2, 21, 17, Noise); }

TEST_P(EveryMethod, ConstantImagesGiveSoundMaps) {
  for (const int grey : {0, 128, 255}) {
    ExpectSoundMaps(
        3, 20, 15, [=](int, int, int) { return static_cast<uint8_t>(grey); });
  }
}

TEST_P(EveryMethod, OnlyOneTexturedImageGivesSoundMaps) {
  ExpectSoundMaps(3, 20, 15, [](int view, int col, int row) {
    return view == 1 ? Noise(view, col, row) : uint8_t{255};
  });
}

TEST_P(EveryMethod, BlackAndWhiteCheckersGiveSoundMaps) {
  ExpectSoundMaps(3, 20, 15, [](int, int col, int row) {
    return static_cast<uint8_t>((col + row) % 2 * 255);
  });
}

TEST_P(EveryMethod, SourcesThatSeeNothingGiveSoundMaps) {
  auto views = PaintedViews(3, 12, 9, Noise);
  views[1].camera.t = {0, 0, -100};                     // beyond the scene
  views[2].camera.R = {{-1, 0, 0, 0, 1, 0, 0, 0, -1}};  // looks back
  ScheduleOptions options;
  options.method = GetParam();
  const auto maps = EstimateScene(&workers_, views, options, 1);
  ExpectSound(maps[0], views[0].camera);
}

}  // namespace
}  // namespace hpm
