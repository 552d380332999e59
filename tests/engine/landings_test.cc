#include "src/core/rng.h"
#include "src/engine/landings_simd.h"
#include "tests/engine/compare_maps.h"

#include <cmath>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace hpm {
namespace {

constexpr Landing kNowhere = {-1, 0, 0};

// What LandRow() computes, for one pixel.
Landing ReadableLanding(const SourcePose& pose,
                        const Surroundings<float>& inverse_depth,
                        int col,
                        int row) {
  const Vec3f q =
      pose.to_ref.M *
          Vec3f{static_cast<float>(col), static_cast<float>(row), 1} +
      inverse_depth.here * pose.to_ref.v;
  if (!(q.z > 0)) return kNowhere;
  const float u = std::floor(q.x / q.z + 0.5f);
  const float v = std::floor(q.y / q.z + 0.5f);
  if (!(u >= 0 && v >= 0 && u < static_cast<float>(pose.ref.width) &&
        v < static_cast<float>(pose.ref.height))) {
    return kNowhere;
  }
  const Plane plane = PlaneOfSource(pose, inverse_depth, col, row);
  const Vec3f ray = RayAt(pose.ref, u, v);
  const float z = DepthOnRay(plane, ray);
  if (!(plane.distance > 0 && z >= pose.z_min && z <= pose.z_max &&
        Dot(plane.normal, ray) < -kMinFacing * Norm(ray))) {
    return kNowhere;
  }
  return {static_cast<int32_t>(u), static_cast<int32_t>(v), 1 / z};
}

// A source turned and moved against the reference.
SourcePose PoseOf(int width, int height) {
  SourcePose pose = {};
  pose.ref = {width, height, 200, 190, 0.5f * width, 0.5f * height, {}, {}};
  pose.ref.R = {{1, 0, 0, 0, 1, 0, 0, 0, 1}};
  pose.src = pose.ref;
  const float c = std::cos(0.2f), s = std::sin(0.2f);
  pose.src.R = {{c, 0, s, 0, 1, 0, -s, 0, c}};
  pose.src.t = {-0.6f, 0.1f, 0.2f};
  pose.to_ref = MakeViewWarp(pose.src, pose.ref);
  pose.rotation = pose.ref.R * Transposed(pose.src.R);
  pose.ref_center = CamFromWorld(pose.src, Center(pose.ref));
  pose.z_min = 2.5f;
  pose.z_max = 6;
  return pose;
}

// Surfaces at several depths, some too steep, some nothing at all.
std::vector<float> RoughInverseDepths(int width, int height) {
  std::vector<float> values;
  for (int row = 0; row < height; ++row) {
    for (int col = 0; col < width; ++col) {
      const int patch = col / 23 + 7 * (row / 19);
      Rng rng(5, patch, 0);
      const float depth = 2 + 5 * rng.Uniform();
      const float slope = 0.03f * rng.Uniform(-1, 1);
      const float value = (1 + slope * static_cast<float>(col % 23)) / depth;
      values.push_back(patch % 5 == 0 ? 0 : value);
    }
  }
  return values;
}

TEST(LandRow, AllTargetsGiveTheBytesOfTheReadableForm) {
  for (const auto& [width, height, step] :
       {std::tuple(5, 5, 1), {38, 21, 2}, {161, 120, 1}, {250, 90, 2}}) {
    const SourcePose pose = PoseOf(width, height);
    const std::vector<float> all = RoughInverseDepths(width, height);
    const int num_cols = (width - 1) / step + 1, reach = kReach / step;
    const auto every = [&, w = width, s = step](int row) {
      std::vector<float> values(num_cols + kMaxLandingLanes);
      for (int k = 0; k < num_cols; ++k) values[k] = all[row * w + s * k];
      return values;
    };
    int num_landed = 0, num_pixels = 0;
    for (int row = kReach; row + kReach < height; ++row) {
      const std::vector<float> own = every(row), above = every(row - kReach),
                               below = every(row + kReach);
      const int num = num_cols - 2 * reach;
      std::vector<Landing> expected;
      for (int k = reach; k < num + reach; ++k) {
        expected.push_back(ReadableLanding(
            pose,
            {own[k], own[k - reach], own[k + reach], above[k], below[k]},
            step * k,
            row));
        num_landed += expected.back().col >= 0;
        ++num_pixels;
      }
      for (const int64_t target : hwy::SupportedAndGeneratedTargets()) {
        std::vector<Landing> landings(num + kMaxLandingLanes);
        hwy::SetSupportedTargetsForTest(target);
        LandRow(pose,
                {&own[reach],
                 &own[0],
                 &own[2 * reach],
                 &above[reach],
                 &below[reach]},
                kReach,
                step,
                row,
                num,
                landings.data());
        hwy::SetSupportedTargetsForTest(0);
        landings.resize(num);
        for (Landing& landing : landings)
          if (landing.col < 0) landing = kNowhere;
        EXPECT_TRUE(SameBytes(landings, expected))
            << hwy::TargetName(target) << " " << width << "x" << height
            << ", row " << row;
      }
    }
    if (width < 161) continue;
    EXPECT_GT(num_landed, 0.2 * num_pixels);
    EXPECT_LT(num_landed, 0.8 * num_pixels);
  }
}

}  // namespace
}  // namespace hpm
