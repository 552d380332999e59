// The card's form of the matching cost against the one of src/core.
#include "src/gpu/lane_cost.h"
#include "src/gpu/texel_image.h"
#include "tests/cpu/scene_views.h"
#include "tests/gpu/core_cost.h"
#include "tests/gpu/emulated_backend.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hpm {
namespace {

struct Difference {
  int num_pairs = 0, num_visible = 0, num_visibility_differs = 0;
  double sum = 0;
  float largest = 0;
};

template <class Sampler>
Difference Compare(const std::string& scene, bool masked = false) {
  SceneOptions options;
  options.num_views = 6;
  options.width = 60;
  options.height = 44;
  options.quarter_turns = {0, 0, 1, 2, 0, 3};
  const auto rendered = RenderViews(MakeScene(scene, options), 1);
  EmulatedBackend backend({});
  ViewSet set = AsViewSet(rendered);
  if (masked) {
    set.ref = WithGap(set.ref, 10);
    for (View& src : set.srcs) src = WithGap(src, 30);
  }
  backend.SetViews(set, MethodParams());
  const DeviceProblem& problem = backend.problem();
  std::mt19937 random(1);
  Difference result;
  for (int row = 0; row < options.height; row += 2) {
    for (int col = 0; col < options.width; col += 3) {
      const RefPatch patch = RefPatchAt(problem, col, row);
      WindowSample samples[kPatchSize];
      StoreWindow(patch, samples, 1);
      const Window window = {
          samples, 1, patch.center, patch.mean, patch.variance};
      const LaneCost<Sampler> cost(problem, window, col, row);
      const CoreCost core(problem, patch, col, row);
      for (int i = 0; i < 5; ++i) {
        const Plane plane = SomeHypothesis(rendered[0], col, row, &random);
        const uint8_t views[] = {0, 1, 2, 3, 4};
        float actual[5], expected[5];
        cost.Photometric(&plane, 1, views, 5, actual);
        core.Photometric(&plane, 1, views, 5, expected);
        for (int k = 0; k < 5; ++k) {
          EXPECT_TRUE(actual[k] >= 0 && actual[k] <= kMaxCost);
          ++result.num_pairs;
          const float difference = std::abs(actual[k] - expected[k]);
          // A position at the border of the image may fall on either side.
          if ((actual[k] == kMaxCost) != (expected[k] == kMaxCost) &&
              difference > 0.1f) {
            ++result.num_visibility_differs;
            continue;
          }
          result.num_visible += expected[k] < kMaxCost;
          result.sum += difference;
          result.largest = std::fmax(result.largest, difference);
        }
      }
    }
  }
  return result;
}

class EveryScene : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(PairCost,
                         EveryScene,
                         testing::Values("sphere",
                                         "depth_step",
                                         "low_texture_wall"),
                         [](const auto& test) { return test.param; });

TEST_P(EveryScene, ExactInterpolationGivesTheCostOfTheCore) {
  const Difference d = Compare<QuadSampler>(GetParam());
  EXPECT_GT(d.num_visible, 3000);
  EXPECT_LT(d.largest, 1e-2f);
  EXPECT_LE(d.num_visibility_differs, d.num_pairs / 2000);
}

TEST(PairCost, MaskedPixelsAreNotMatched) {
  const Difference all = Compare<QuadSampler>("sphere");
  const Difference quad = Compare<QuadSampler>("sphere", true);
  const Difference texture = Compare<TextureSampler>("sphere", true);
  EXPECT_GT(quad.num_visible, 500);
  EXPECT_LT(quad.num_visible, all.num_visible * 3 / 4);
  EXPECT_LT(quad.largest, 1e-2f);
  EXPECT_LE(quad.num_visibility_differs, quad.num_pairs / 1000);
  EXPECT_LE(texture.num_visibility_differs, texture.num_pairs / 1000);
}

// Fractions of 1/256 pixel: the mean tells what it costs, the largest value
// stands where windows are nearly constant and grey levels hardly differ.
TEST_P(EveryScene, TheTextureUnitsFractionsMoveCostsLittle) {
  const Difference d = Compare<TextureSampler>(GetParam());
  const double mean = d.sum / d.num_pairs;
  std::printf("%s: mean %.6f, largest %.4f\n",
              GetParam().c_str(),
              mean,
              static_cast<double>(d.largest));
  EXPECT_GT(d.num_visible, 3000);
  EXPECT_LT(mean, 2e-3);
  EXPECT_LT(d.largest, 0.2f);
  EXPECT_LE(d.num_visibility_differs, d.num_pairs / 2000);
}

TEST(TexelImage, HoldsTheTwoByTwoNeighbourhoodClampedAtTheBorder) {
  GrayImage image{7, 5, {}};
  std::mt19937 random(3);
  for (int i = 0; i < 35; ++i) {
    image.data.push_back(static_cast<uint8_t>(random()));
  }
  for (int i = 0; i < 35; ++i) {
    const int col = i % 7, row = i / 7;
    const int right = std::min(col + 1, 6), below = std::min(row + 1, 4);
    const uint32_t texel = TexelAt(image.data.data(), 7, 5, col, row);
    EXPECT_EQ(ByteOf(texel, 0), image.at(col, row));
    EXPECT_EQ(ByteOf(texel, 1), image.at(right, row));
    EXPECT_EQ(ByteOf(texel, 2), image.at(col, below));
    EXPECT_EQ(ByteOf(texel, 3), image.at(right, below));
  }
}

TEST(FastMath, SplitsPositionsAndBytes) {
  for (const float x : {0.0f, 0.25f, 1.0f, 3199.999f, 31999.5f}) {
    float fraction;
    const int whole = SplitPosition(x, &fraction);
    EXPECT_EQ(static_cast<float>(whole) + fraction, x);
    EXPECT_TRUE(fraction >= 0 && fraction < 1);
  }
  for (int i = 0; i < 4; ++i)
    EXPECT_EQ(ByteOf(0xFF804001u, i),
              (std::array{1.0f, 64.0f, 128.0f, 255.0f})[i]);
}

}  // namespace
}  // namespace hpm
