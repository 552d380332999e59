#include "src/engine/local_planes.h"

#include "src/core/rng.h"
#include "tests/prior/prior_scene.h"

#include <cmath>

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace hpm
