#include "src/core/geometric_term.h"

#include "tests/core/test_cameras.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr float kMaxError = 5;

using InverseDepthFunction = std::function<float(float u, float v)>;

float ErrorOf(const Camera& ref,
              const Camera& src,
              const Plane& plane,
              float col,
              float row,
              const InverseDepthFunction& inverse_depth) {
  return ReprojectionError(Reproject(MakeViewWarp(ref, src),
                                     MakeViewWarp(src, ref),
                                     SlopeOf(ref, plane),
                                     col,
                                     row,
                                     inverse_depth),
                           col,
                           row,
                           kMaxError);
}

// The plane in the frame of another camera.
Plane Moved(const Camera& from, const Camera& to, const Plane& plane) {
  const Mat3f R = to.R * Transposed(from.R);
  const Vec3f t = to.t - R * from.t;
  const Vec3f normal = R * plane.normal;
  return {normal, plane.distance - Dot(normal, t)};
}

// Three bytes each, one behind the last; see InverseDepths.
std::vector<uint8_t> Packed(const std::vector<uint32_t>& steps) {
  std::vector<uint8_t> bytes;
  for (const uint32_t s : steps) {
    for (const int shift : {0, 8, 16})
      bytes.push_back(static_cast<uint8_t>(s >> shift));
  }
  bytes.push_back(0xff);
  return bytes;
}

// Inverse depths of a plane at pixel centres.
constexpr float kStep = 1e-7f;

std::vector<uint8_t> InverseDepthsOf(const Camera& camera, const Plane& plane) {
  std::vector<uint32_t> steps;
  for (int row = 0; row < camera.height; ++row) {
    for (int col = 0; col < camera.width; ++col) {
      const double z = PointOn(camera, plane, col, row).z();
      steps.push_back(
          z > 0.6 ? static_cast<uint32_t>(std::lround(1 / z / kStep)) : 0);
    }
  }
  return Packed(steps);
}

InverseDepthFunction LookUp(const Camera& camera,
                            const std::vector<uint8_t>& map) {
  return [&camera, &map](float u, float v) {
    return InterpolateInverseDepth(
        {map.data(), kStep}, camera.width, camera.height, u, v);
  };
}

TEST(ReprojectionError, IsZeroOnExactPlanesForAnyPairOfCameras) {
  Random random(21);
  int num_checked = 0;
  for (int i = 0; i < 60; ++i) {
    const Camera ref = RandomCamera(&random);
    const Camera src = RandomCamera(&random);
    const Vec3f normal = RandomFacingNormal(&random);
    const Plane plane = PlaneFromDepth(ref, ref.cx, ref.cy, 5, normal);
    const Plane there = Moved(ref, src, plane);
    if (there.distance < 1) continue;
    const std::vector<uint8_t> map = InverseDepthsOf(src, there);
    for (int row = 0; row < ref.height; row += 23) {
      for (int col = 0; col < ref.width; col += 23) {
        const Eigen::Vector3d point = PointOn(ref, plane, col, row);
        const Eigen::Vector3d pixel = ProjectInto(src, InWorld(ref, point));
        // Not beyond the outermost pixel centres, where nothing can be
        // interpolated, and not at grazing angles, where the source's
        // neighbouring depths differ like those of two surfaces.
        const Eigen::Vector3d in_src = InCamera(src, InWorld(ref, point));
        const double facing = -ToEigen(there.normal).dot(in_src.normalized());
        if (!(point.z() > 1 && pixel.z() > 1 && facing > 0.7 && pixel.x() > 0 &&
              pixel.y() > 0 && pixel.x() < src.width - 1 &&
              pixel.y() < src.height - 1)) {
          continue;
        }
        EXPECT_LT(ErrorOf(ref,
                          src,
                          plane,
                          static_cast<float>(col),
                          static_cast<float>(row),
                          LookUp(src, map)),
                  1e-2);
        ++num_checked;
      }
    }
  }
  EXPECT_GT(num_checked, 1000);
}

// Cameras side by side, a wall at depth Z, the hypothesis at Z (1 + x): the way
// there and back misses by f B / Z * x / (1 + x) pixels.
TEST(ReprojectionError, OfADepthThatIsOffIsTheClosedForm) {
  constexpr float kFocal = 100, kBase = 0.5f, kDepth = 5;
  const Camera ref = MakeTestCamera(120, 90, kFocal, 0, {0, 0, 0});
  const Camera src = MakeTestCamera(120, 90, kFocal, 0, {kBase, 0, 0});
  for (const float x : {-0.2f, -0.01f, 0.001f, 0.02f, 0.1f, 0.3f}) {
    const Plane plane =
        PlaneFromDepth(ref, 60, 40, kDepth * (1 + x), {0, 0, -1});
    const float error = ErrorOf(
        ref, src, plane, 60, 40, [&](float, float) { return 1 / kDepth; });
    EXPECT_NEAR(error, kFocal * kBase / kDepth * std::abs(x / (1 + x)), 1e-4)
        << x;
  }
}

TEST(ReprojectionError, IsCapped) {
  const Camera ref = MakeTestCamera(120, 90, 100, 0, {0, 0, 0});
  const Camera src = MakeTestCamera(120, 90, 100, 0, {0.5, 0, 0});
  const auto wall = [](float, float) { return 0.2f; };
  const Plane far_off = PlaneFromDepth(ref, 60, 40, 12, {0, 0, -1});
  EXPECT_EQ(ErrorOf(ref, src, far_off, 60, 40, wall), kMaxError);
}

TEST(ReprojectionError, IsTheCapWithoutDepthOrView) {
  const Camera ref = MakeTestCamera(120, 90, 100, 0, {0, 0, 0});
  const Camera beside = MakeTestCamera(120, 90, 100, 0, {0.5, 0, 0});
  const Camera far_away = MakeTestCamera(120, 90, 100, 0, {50, 0, 0});
  const Camera ahead = MakeTestCamera(120, 90, 100, 0, {0, 0, 8});
  const Plane plane = PlaneFromDepth(ref, 60, 40, 5, {0, 0, -1});
  const auto wall = [](float, float) { return 0.2f; };
  EXPECT_LT(ErrorOf(ref, beside, plane, 60, 40, wall), 1e-3);
  EXPECT_EQ(
      ErrorOf(ref, beside, plane, 60, 40, [](float, float) { return 0.0f; }),
      kMaxError);
  EXPECT_EQ(ErrorOf(ref, far_away, plane, 60, 40, wall), kMaxError);
  EXPECT_EQ(ErrorOf(ref, ahead, plane, 60, 40, wall), kMaxError);
  EXPECT_EQ(ErrorOf(ref, beside, {{0, 0, 0}, 0}, 60, 40, wall), kMaxError);
}

class Interpolation : public testing::Test {
 protected:
  float At(float u, float v) const {
    return InterpolateInverseDepth({map_.data(), 1e-6f}, 3, 2, u, v);
  }
  std::vector<uint8_t> map_ =
      Packed({200000, 201000, 100000, 202000, 203000, 101000});
};

TEST_F(Interpolation, IsBilinearOnOneSurface) {
  EXPECT_FLOAT_EQ(At(0, 0), 0.200f);
  EXPECT_FLOAT_EQ(At(0.5f, 0), 0.2005f);
  EXPECT_FLOAT_EQ(At(0.25f, 0.5f), 0.20125f);
}

TEST_F(Interpolation, TakesTheNearestPixelAcrossAStep) {
  EXPECT_FLOAT_EQ(At(1.4f, 0.2f), 0.201f);
  EXPECT_FLOAT_EQ(At(1.6f, 0.2f), 0.100f);
  EXPECT_FLOAT_EQ(At(1.6f, 0.8f), 0.101f);
}

TEST_F(Interpolation, NeverMixesInMissingDepth) {
  std::fill_n(map_.begin() + 4 * 3, 3, uint8_t{0});
  EXPECT_FLOAT_EQ(At(0.3f, 0.3f), 0.200f);
  EXPECT_FLOAT_EQ(At(0.9f, 0.9f), 0);
}

TEST_F(Interpolation, ClampsAtTheBorder) {
  EXPECT_FLOAT_EQ(At(-0.5f, -0.5f), 0.200f);
  EXPECT_FLOAT_EQ(At(2.5f, 1.5f), 0.101f);
}

}  // namespace
}  // namespace hpm
