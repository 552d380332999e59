#include "src/base/error.h"
#include "src/cpu/cpu_views.h"
#include "tests/cpu/scene_views.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

// Sums of 36 products in another order and with fused multiply-adds; positions
// differ in the last digit, which moves a sample by less than 1e-4 pixels.
// Where the cut colour weights leave little variance, rounding counts most.
constexpr float kTolerance = 1e-2f;
SceneOptions Options(int num_views) {
  SceneOptions options;
  options.num_views = num_views;
  options.width = 60;
  options.height = 44;
  options.quarter_turns = {0, 0, 1, 2, 0, 3};
  return options;
}

struct Comparison {
  int num_pairs = 0;
  int num_visible = 0;
  float largest = 0;
  int num_visibility_differs = 0;  // one says kMaxCost, the other does not
};

// All targets against the scalar one for `planes` in `views` at one pixel.
void Compare(const CpuTarget& target,
             const CpuViews& cpu_views,
             int col,
             int row,
             const std::vector<Plane>& planes,
             const std::vector<uint8_t>& views,
             Comparison* result) {
  const int num_planes = static_cast<int>(planes.size());
  const int num_views = static_cast<int>(views.size());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> expected(planes.size() * views.size() + 1, nan);
  std::vector<float> actual = expected;
  for (const auto& [each, costs] :
       {std::pair(FindCpuTarget("scalar"), &expected),
        std::pair(target, &actual)}) {
    CpuPixelCost(cpu_views, each, 0, col, row)
        .Photometric(
            planes.data(), num_planes, views.data(), num_views, costs->data());
  }
  EXPECT_TRUE(std::isnan(actual.back()));  // written behind the last pair
  for (size_t i = 0; i + 1 < actual.size(); ++i) {
    ASSERT_GE(actual[i], 0);  // false for NaN
    ASSERT_LE(actual[i], kMaxCost);
    ++result->num_pairs;
    result->num_visible += expected[i] < kMaxCost;
    const float difference = std::abs(actual[i] - expected[i]);
    if ((actual[i] == kMaxCost) != (expected[i] == kMaxCost) &&
        difference > kTolerance) {
      ++result->num_visibility_differs;
    } else {
      result->largest = std::fmax(result->largest, difference);
    }
  }
}

void ExpectAgreement(const Comparison& result) {
  EXPECT_LT(result.largest, kTolerance);
  // A centre exactly on the border of the source image may fall on either side.
  EXPECT_LE(result.num_visibility_differs, result.num_pairs / 2000);
}

class EveryTarget : public testing::TestWithParam<CpuTarget> {};
INSTANTIATE_TEST_SUITE_P(CpuTargets,
                         EveryTarget,
                         testing::ValuesIn(CpuTargets()),
                         [](const auto& test) { return test.param.name; });

TEST_P(EveryTarget, AgreesWithTheScalarCostOnRenderedScenes) {
  Comparison result;
  std::mt19937 random(1);
  for (const char* name : {"sphere", "depth_step", "low_texture_wall"}) {
    const std::vector<RenderedView> rendered =
        RenderViews(MakeScene(name, Options(8)), 1);
    const CpuViews cpu_views(AsViewSet(rendered), MethodParams());
    const std::vector<uint8_t> views = {0, 1, 2, 3, 4, 5, 6};
    for (int row = 0; row < 44; row += 3) {
      for (int col = 0; col < 60; col += 3) {
        std::vector<Plane> planes;
        for (int i = 0; i < 5; ++i) {
          planes.push_back(SomeHypothesis(rendered[0], col, row, &random));
        }
        Compare(GetParam(), cpu_views, col, row, planes, views, &result);
      }
    }
  }
  EXPECT_GT(result.num_pairs, 30000);
  EXPECT_GT(result.num_visible, 10000);
  EXPECT_LT(result.num_visible, result.num_pairs);
  ExpectAgreement(result);
}

// Half of the views have gaps, half have none but black pixels.
TEST_P(EveryTarget, AgreesOnWhatIsMasked) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("sphere", Options(8)), 1);
  ViewSet set = AsViewSet(rendered);
  const CpuViews without(set, MethodParams());
  set.ref = WithGap(set.ref, 10);
  for (size_t j = 0; j < set.srcs.size(); ++j) {
    GrayImage image = *WithGap(set.srcs[j], 30).image;
    image.has_gaps = j % 2 == 0;
    set.srcs[j].image = std::make_shared<const GrayImage>(image);
  }
  const CpuViews cpu_views(set, MethodParams());
  Comparison result, unmasked;
  std::mt19937 random(1);
  for (int row = 0; row < 44; row += 3) {
    for (int col = 0; col < 60; col += 3) {
      std::vector<Plane> planes;
      for (int i = 0; i < 5; ++i)
        planes.push_back(SomeHypothesis(rendered[0], col, row, &random));
      for (const uint8_t view : {0, 1, 2, 3, 4, 5, 6})
        Compare(GetParam(), cpu_views, col, row, planes, {view}, &result);
      const std::vector<uint8_t> views = {0, 1, 2, 3, 4, 5, 6};
      Compare(GetParam(), cpu_views, col, row, planes, views, &result);
      Compare(GetParam(), without, col, row, planes, views, &unmasked);
    }
  }
  EXPECT_GT(result.num_visible, 3000);
  EXPECT_LT(result.num_visible, unmasked.num_visible * 2 * 9 / 10);
  // At the edge of a gap grey values jump to 0: there a position's last digit
  // counts for more.
  EXPECT_LT(result.largest, 3 * kTolerance);
  // A centre exactly between a gap and a pixel may fall on either side.
  EXPECT_LE(result.num_visibility_differs, result.num_pairs / 1000);
}

// Any number of planes and of views, so that vectors are filled in every way,
// and views in any order.
TEST_P(EveryTarget, AgreesForEveryNumberOfPlanesAndViews) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("sphere", Options(8)), 1);
  // 32 views, the limit: each source several times.
  ViewSet set = AsViewSet(rendered);
  for (int i = 7; i < kMaxViews; ++i) set.srcs.push_back(set.srcs[i % 7]);
  const CpuViews cpu_views(set, MethodParams());
  Comparison result;
  std::mt19937 random(2);
  for (int num_planes = 1; num_planes <= kNumRegions; ++num_planes) {
    for (int num_views = 1; num_views <= kMaxViews; ++num_views) {
      std::vector<Plane> planes;
      for (int i = 0; i < num_planes; ++i) {
        planes.push_back(SomeHypothesis(rendered[0], 30, 20, &random));
      }
      std::vector<uint8_t> views;
      for (int j = 0; j < num_views; ++j) {
        views.push_back(static_cast<uint8_t>(random() % kMaxViews));
      }
      Compare(GetParam(), cpu_views, 30, 20, planes, views, &result);
    }
  }
  ExpectAgreement(result);
}

// Narrow and low images: every sample is near a border.
TEST_P(EveryTarget, AgreesForSourceImagesOfAnySize) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("tilted_plane", Options(3)), 1);
  const ViewSet full = AsViewSet(rendered);
  Comparison result;
  std::mt19937 random(3);
  for (int width = 1; width <= 33; ++width) {
    const int height = 1 + width * 7 % 23;
    ViewSet set = full;
    set.srcs[0] = Cropped(full.srcs[0], 13, 11, width, height);
    set.srcs[1] = Cropped(full.srcs[1], 20, 9, height, width);
    const CpuViews cpu_views(set, MethodParams());
    for (int i = 0; i < 80; ++i) {
      const int col = static_cast<int>(random() % 60);
      const int row = static_cast<int>(random() % 44);
      const std::vector<Plane> planes = {
          SomeHypothesis(rendered[0], col, row, &random),
          SomeHypothesis(rendered[0], col, row, &random),
          SomeHypothesis(rendered[0], col, row, &random)};
      Compare(GetParam(), cpu_views, col, row, planes, {0, 1}, &result);
    }
  }
  EXPECT_GT(result.num_visible, 500);
  ExpectAgreement(result);
}

TEST_P(EveryTarget, NonsensePlanesCostTheMaximum) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("tilted_plane", Options(3)), 1);
  const CpuViews cpu_views(AsViewSet(rendered), MethodParams());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  const std::vector<Plane> planes = {{{nan, nan, nan}, nan},
                                     {{0, 0, -1}, nan},
                                     {{0, 0, 0}, 0},
                                     {{0, 0, -1}, 0},
                                     {{inf, 0, -1}, 1},
                                     {{0, 0, -1}, 1e-38f},
                                     {{0, 0, -1}, -5}};
  const std::vector<uint8_t> views = {0, 1};
  std::vector<float> costs(planes.size() * 2);
  CpuPixelCost(cpu_views, GetParam(), 0, 30, 20)
      .Photometric(planes.data(),
                   static_cast<int>(planes.size()),
                   views.data(),
                   2,
                   costs.data());
  EXPECT_THAT(costs, testing::Each(kMaxCost));
}

// What a pixel asks for does not depend on who asks with it: groups of any
// size, some without texture, some that ask for nothing.
TEST_P(EveryTarget, GroupsHaveTheCostsOfTheirPixels) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("sphere", Options(8)), 1);
  ViewSet set = AsViewSet(rendered);
  set.ref = WithGap(set.ref, 10);  // where nothing matches
  for (int i = 7; i < kMaxViews; ++i) set.srcs.push_back(set.srcs[i % 7]);
  const CpuViews cpu_views(set, MethodParams());
  std::mt19937 random(5);
  int num_requests = 0, num_finite = 0;
  for (int round = 0; round < 60; ++round) {
    const int num_pixels = 1 + static_cast<int>(random() % kMaxGroup);
    const int max_planes = 1 + static_cast<int>(random() % kNumRegions);
    const int max_views = 1 + static_cast<int>(random() % kMaxViews);
    const int row = static_cast<int>(random() % 44);
    RefPatches patches;
    struct Asked {
      std::vector<Plane> planes;
      std::vector<uint8_t> views;
      std::vector<float> costs;
    };
    std::vector<Asked> asked(num_pixels);
    std::vector<MatchRequest> requests;
    for (int pixel = 0; pixel < num_pixels; ++pixel) {
      const int col = 2 * pixel + 4;
      patches.Set(pixel, cpu_views.PatchAt(col, row));
      if (random() % 4 == 0) continue;
      Asked& of_pixel = asked[pixel];
      for (size_t i = 0; i <= random() % max_planes; ++i)
        of_pixel.planes.push_back(
            SomeHypothesis(rendered[0], col, row, &random));
      for (size_t i = 0; i <= random() % max_views; ++i)
        of_pixel.views.push_back(static_cast<uint8_t>(random() % kMaxViews));
      of_pixel.costs.resize(of_pixel.planes.size() * of_pixel.views.size(), -1);
      requests.push_back({{col,
                           row,
                           of_pixel.planes.data(),
                           static_cast<int>(of_pixel.planes.size()),
                           of_pixel.views.data(),
                           static_cast<int>(of_pixel.views.size())},
                          pixel,
                          of_pixel.costs.data()});
    }
    GetParam().match_costs(cpu_views.match(),
                           patches,
                           requests.data(),
                           static_cast<int>(requests.size()));
    for (const MatchRequest& request : requests) {
      const PlanesInViews& alone = request.asked;
      std::vector<float> expected(alone.num_pairs());
      CpuPixelCost(cpu_views, GetParam(), 0, alone.col, alone.row)
          .Photometric(alone.planes,
                       alone.num_planes,
                       alone.views,
                       alone.num_views,
                       expected.data());
      EXPECT_EQ(asked[request.pixel].costs, expected) << request.pixel;
      ++num_requests;
      num_finite += std::count_if(expected.begin(),
                                  expected.end(),
                                  [](float cost) { return cost < kMaxCost; });
    }
  }
  EXPECT_GT(num_requests, 200);
  EXPECT_GT(num_finite, 1000);
}

// Source maps with steps, gaps and none at all, views in any number and order.
TEST_P(EveryTarget, AgreesWithTheScalarGeometricErrors) {
  const std::vector<RenderedView> rendered =
      RenderViews(MakeScene("depth_step", Options(6)), 1);
  ViewSet set = AsViewSet(rendered);
  std::mt19937 random(4);
  for (size_t j = 0; j + 1 < set.srcs.size(); ++j) {
    std::vector<float> inverse;
    for (const float z : rendered[j + 1].truth.depth)
      inverse.push_back(random() % 20 == 0 ? 0 : 1 / z);
    set.srcs[j].inverse_depth =
        std::make_shared<const InverseDepthMap>(InverseDepthMap::Of(inverse));
  }
  const CpuViews cpu_views(set, MethodParams());
  constexpr float kMaxError = 5;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  int num_checked = 0, num_small = 0, num_far_apart = 0;
  for (int row = 0; row < 44; row += 2) {
    for (int col = 0; col < 60; col += 2) {
      std::vector<Plane> planes = {{{nan, nan, nan}, nan}, {{0, 0, -1}, -5}};
      for (int i = 0; i < 4; ++i)
        planes.push_back(SomeHypothesis(rendered[0], col, row, &random));
      std::vector<uint8_t> views;
      for (size_t k = 0; k <= random() % 7; ++k)
        views.push_back(static_cast<uint8_t>(random() % set.srcs.size()));
      const PlanesInViews request = {col,
                                     row,
                                     planes.data(),
                                     static_cast<int>(planes.size()),
                                     views.data(),
                                     static_cast<int>(views.size())};
      std::vector<float> expected(planes.size() * views.size() + 1, nan);
      std::vector<float> actual = expected;
      for (const auto& [target, errors] :
           {std::pair(FindCpuTarget("scalar"), &expected),
            std::pair(GetParam(), &actual)}) {
        target.geometric_errors(set.ref.camera,
                                cpu_views.depth_views(),
                                kMaxError,
                                request,
                                errors->data());
      }
      EXPECT_TRUE(std::isnan(actual.back()));  // written behind the last pair
      for (size_t i = 0; i + 1 < actual.size(); ++i) {
        ++num_checked;
        num_small += expected[i] > 0 && expected[i] < 1;
        // A position exactly between two taps, or on the border.
        num_far_apart += !(std::abs(actual[i] - expected[i]) < 1e-2f);
        if (i < 2 * views.size()) {
          EXPECT_EQ(actual[i], expected[i]);
        }
      }
    }
  }
  EXPECT_GT(num_checked, 10000);
  EXPECT_GT(num_small, 1000);
  EXPECT_LE(num_far_apart, num_checked / 1000);
}

TEST(CpuTargets, EndWithScalarAndHaveDistinctNames) {
  const std::vector<CpuTarget> targets = CpuTargets();
  ASSERT_FALSE(targets.empty());
  EXPECT_EQ(targets.back().name, "scalar");
  for (size_t i = 0; i < targets.size(); ++i) {
    for (size_t j = 0; j < i; ++j) EXPECT_NE(targets[i].name, targets[j].name);
    EXPECT_EQ(FindCpuTarget(targets[i].name).match_costs,
              targets[i].match_costs);
  }
  EXPECT_EQ(FindCpuTarget("auto").name, targets.front().name);
}

TEST(CpuTargets, UnknownNameIsAnErrorThatListsTheNames) {
  try {
    FindCpuTarget("pdp11");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    for (const CpuTarget& target : CpuTargets()) {
      EXPECT_THAT(error.what(), testing::HasSubstr(target.name));
    }
  }
}

}  // namespace
}  // namespace hpm
