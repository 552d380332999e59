#include "src/engine/local_planes.h"

#include "src/core/rng.h"
#include "tests/engine/compare_maps.h"
#include "tests/engine/readable_local_planes.h"
#include "tests/prior/prior_scene.h"

#include <cmath>
#include <cstring>
#include <utility>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace hpm {
namespace {

constexpr int kWidth = 60, kHeight = 48;
constexpr float kTolerance = 2e-3f;  // 1/z

class LocalPlanesTest : public testing::Test {
 protected:
  LocalPlanesTest()
      : camera_(PriorCamera(kWidth, kHeight)),
        image_{kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 100)},
        map_(kWidth, kHeight) {}

  // The plane's points, 1/z off by up to `noise`, every one with a normal of
  // its own where `tilt` > 0.
  void Fill(const Plane& plane, float noise, float tilt) {
    for (int row = 0; row < kHeight; ++row) {
      for (int col = 0; col < kWidth; ++col) Set(plane, noise, tilt, col, row);
    }
  }
  void Set(const Plane& plane, float noise, float tilt, int col, int row) {
    Rng rng(1, col, row);
    const auto x = static_cast<float>(col), y = static_cast<float>(row);
    const float inverse_depth =
        1 / DepthAt(camera_, plane, x, y) + noise * rng.Uniform(-1, 1);
    const Vec3f normal = Normalized(
        plane.normal +
        Vec3f{tilt * rng.Uniform(-1, 1), tilt * rng.Uniform(-1, 1), 0});
    map_.planes[row * kWidth + col] =
        PlaneFromDepth(camera_, x, y, 1 / inverse_depth, normal);
  }
  void Fit() { FitLocalPlanes(camera_, image_, kTolerance, range_, &map_); }

  // Mean angle to `truth` in degrees and mean error of 1/z over columns
  // [left, right).
  std::pair<double, double> Errors(const Plane& truth,
                                   int left = 0,
                                   int right = kWidth) const {
    double angle = 0, depth = 0;
    for (int row = 0; row < kHeight; ++row) {
      for (int col = left; col < right; ++col) {
        const Plane& plane = map_.planes[row * kWidth + col];
        const auto x = static_cast<float>(col), y = static_cast<float>(row);
        angle += std::acos(std::min(1.0f, Dot(plane.normal, truth.normal))) *
                 180 / M_PI;
        depth += std::abs(1 / DepthAt(camera_, plane, x, y) -
                          1 / DepthAt(camera_, truth, x, y));
      }
    }
    const double count = kHeight * (right - left);
    return {angle / count, depth / count};
  }

  Camera camera_;
  GrayImage image_;
  PriorRange range_ = {0.1f, 100};
  HypothesisMap map_;
};

TEST_F(LocalPlanesTest, NoisyPixelsOfAPlaneComeToLieOnIt) {
  Fill(TiltedPlane(), 5e-4f, 0.5f);
  const auto [angle_before, depth_before] = Errors(TiltedPlane());
  Fit();
  const auto [angle, depth] = Errors(TiltedPlane());
  EXPECT_LT(angle, 0.2 * angle_before);
  EXPECT_LT(depth, 0.5 * depth_before);
}

TEST_F(LocalPlanesTest, AnExactPlaneStays) {
  Fill(TiltedPlane(), 0, 0);
  Fit();
  EXPECT_LT(Errors(TiltedPlane()).first, 0.1);
  EXPECT_LT(Errors(TiltedPlane()).second, 1e-5);
}

// The residual keeps the sides of a step apart, though both look alike.
TEST_F(LocalPlanesTest, AStepStaysSharp) {
  Plane far = TiltedPlane();
  far.distance *= 1.3f;
  Fill(TiltedPlane(), 0, 0);
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 30; col < kWidth; ++col) Set(far, 0, 0, col, row);
  }
  Fit();
  EXPECT_LT(Errors(TiltedPlane(), 20, 30).second, 1e-4);
  EXPECT_LT(Errors(far, 30, 40).second, 1e-4);
}

TEST_F(LocalPlanesTest, GapsStayGaps) {
  Fill(TiltedPlane(), 0, 0);
  map_.planes[0].distance = 0;
  map_.planes[kWidth + 7].distance = 0;
  Fit();
  EXPECT_EQ(map_.planes[0].distance, 0);
  EXPECT_EQ(map_.planes[kWidth + 7].distance, 0);
  EXPECT_GT(map_.planes[1].distance, 0);
}

// All pixels lie near the end of the range; a fit would move half of them out.
TEST_F(LocalPlanesTest, NoFitLeavesTheRange) {
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const auto x = static_cast<float>(col), y = static_cast<float>(row);
      map_.planes[row * kWidth + col] = PlaneFromDepth(
          camera_, x, y, (row + col) % 2 == 0 ? 3.0f : 3.01f, {0, 0, -1});
    }
  }
  range_ = {3.01f, 100};
  Fit();
  for (int row = 0; row < kHeight; ++row) {
    for (int col = (row + 1) % 2; col < kWidth; col += 2) {
      const auto x = static_cast<float>(col), y = static_cast<float>(row);
      EXPECT_GT(DepthAt(camera_, map_.planes[row * kWidth + col], x, y),
                3.0099f);
    }
  }
}

TEST_F(LocalPlanesTest, ALonelyPixelKeepsItsPlane) {
  const Plane own = PlaneFromDepth(camera_, 20, 20, 3, {0, 0, -1});
  map_.planes[20 * kWidth + 20] = own;
  Fit();
  const Plane& plane = map_.planes[20 * kWidth + 20];
  EXPECT_NEAR(DepthAt(camera_, plane, 20, 20), 3, 1e-4);
  EXPECT_GT(Dot(plane.normal, own.normal), 0.999);
}

// Surfaces with steps, gaps and edges; some planes point anywhere.
HypothesisMap RoughMap(const Camera& camera, int width, int height) {
  HypothesisMap map(width, height);
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      Rng rng(2, col, row);
      if (rng.Uniform() < 0.1f) continue;
      const float z = (col / 11 + row / 7) % 2 == 0 ? 3 : 3.05f;
      const float tilt = rng.Uniform() < 0.05f ? 3 : 0.3f;
      map.planes[row * width + col] = PlaneFromDepth(
          camera,
          static_cast<float>(col),
          static_cast<float>(row),
          z + 0.01f * rng.Uniform(-1, 1),
          Normalized(
              {tilt * rng.Uniform(-1, 1), tilt * rng.Uniform(-1, 1), -1}));
    }
  }
  return map;
}

TEST(FitLocalPlanes, AllTargetsGiveTheBytesOfTheReadableForm) {
  const std::vector<int64_t> targets = hwy::SupportedAndGeneratedTargets();
  for (const auto& [width, height] :
       {std::pair(1, 1), {2, 9}, {16, 5}, {61, 50}, {200, 40}}) {
    const Camera camera = PriorCamera(width, height);
    GrayImage image = {width, height, std::vector<uint8_t>(width * height)};
    for (int i = 0; i < width * height; ++i) {
      image.data[i] =
          static_cast<uint8_t>(i / 5 % 2 * 180 + 40 * Rng(3, i, 0).Uniform());
    }
    const HypothesisMap start = RoughMap(camera, width, height);
    const PriorRange range = {3, 3.06f};
    HypothesisMap expected = start;
    readable::FitLocalPlanes(camera, image, kTolerance, range, &expected);
    for (const int64_t target : targets) {
      HypothesisMap map = start;
      hwy::SetSupportedTargetsForTest(target);
      FitLocalPlanes(camera, image, kTolerance, range, &map);
      hwy::SetSupportedTargetsForTest(0);
      EXPECT_TRUE(SameBytes(map.planes, expected.planes))
          << hwy::TargetName(target) << " " << width << "x" << height;
    }
    if (width < 61) continue;
    int num_fitted = 0;
    for (size_t i = 0; i < start.planes.size(); ++i) {
      num_fitted +=
          std::memcmp(&start.planes[i], &expected.planes[i], sizeof(Plane)) !=
          0;
    }
    EXPECT_GT(num_fitted, width * height / 2);
    EXPECT_LT(num_fitted, width * height * 0.89);  // gaps and the range
  }
}

}  // namespace
}  // namespace hpm
