#include "src/core/median_filter.h"

#include "tests/core/test_cameras.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 24;
constexpr int kHeight = 17;

struct Field {
  Camera camera = MakeTestCamera(kWidth, kHeight, 30, 0, {0, 0, 0});
  std::vector<Plane> planes = std::vector<Plane>(kWidth * kHeight);
  std::vector<float> costs = std::vector<float>(kWidth * kHeight, 0.5f);
  std::vector<uint32_t> masks = std::vector<uint32_t>(kWidth * kHeight, 1);

  PixelState View() {
    return {
        kWidth, kHeight, planes.data(), costs.data(), masks.data(), nullptr};
  }
  Plane& At(int col, int row) { return planes[row * kWidth + col]; }
  void Set(int col, int row, float depth, const Vec3f& normal) {
    At(col, row) = PlaneFromDepth(camera,
                                  static_cast<float>(col),
                                  static_cast<float>(row),
                                  depth,
                                  normal);
  }
  float Depth(int col, int row) {
    return DepthAt(
        camera, At(col, row), static_cast<float>(col), static_cast<float>(row));
  }
};

const Vec3f kFacing = {0, 0, -1};

Field Flat(float depth) {
  Field field;
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) field.Set(col, row, depth, kFacing);
  }
  return field;
}

Field Noisy(uint32_t seed) {
  Random random(seed);
  Field field;
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      field.Set(col,
                row,
                static_cast<float>(UniformIn(&random, 2, 8)),
                Normalized({0.1f, 0.2f, -1}));
    }
  }
  return field;
}

// The star: axial neighbours at 1, 3, 5 and the knight's moves.
bool IsNeighbour(int dcol, int drow) {
  const int a = std::abs(dcol), b = std::abs(drow);
  if (a == 0 || b == 0) return a + b == 1 || a + b == 3 || a + b == 5;
  return a + b == 3 && a != 0 && b != 0;
}

TEST(MedianFilter, IsTheMedianOfTheStarEvenAtBorders) {
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      Field field = Noisy(7);
      std::vector<float> depths = {field.Depth(col, row)};
      for (int r = 0; r < kHeight; ++r) {
        for (int c = 0; c < kWidth; ++c) {
          if (IsNeighbour(c - col, r - row))
            depths.push_back(field.Depth(c, r));
        }
      }
      std::sort(depths.begin(), depths.end());
      const size_t half = depths.size() / 2;
      const float median = depths.size() % 2 == 1
                               ? depths[half]
                               : (depths[half - 1] + depths[half]) / 2;
      MedianFilterPixel(field.camera, field.View(), col, row);
      EXPECT_NEAR(field.Depth(col, row), median, 1e-5) << col << ", " << row;
    }
  }
}

TEST(MedianFilter, RemovesASpikeAndKeepsItsNormal) {
  Field field = Flat(5);
  const Vec3f normal = Normalized({0.3f, 0, -1});
  field.Set(10, 8, 9, normal);
  MedianFilterPixel(field.camera, field.View(), 10, 8);
  EXPECT_NEAR(field.Depth(10, 8), 5, 1e-5);
  EXPECT_EQ(Norm(field.At(10, 8).normal - normal), 0);
}

TEST(MedianFilter, LeavesPerfectMatchesAlone) {
  Field field = Flat(5);
  field.Set(10, 8, 9, kFacing);
  field.costs[8 * kWidth + 10] = 0.0009f;
  MedianFilterPixel(field.camera, field.View(), 10, 8);
  EXPECT_NEAR(field.Depth(10, 8), 9, 1e-5);
}

TEST(MedianFilter, KeepsAStepBetweenTwoSurfaces) {
  Field field = Flat(5);
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 12; col < kWidth; ++col) field.Set(col, row, 8, kFacing);
  }
  for (int row = 0; row < kHeight; ++row) {
    for (const int col : {9, 10, 11, 12, 13}) {
      Field copy = field;
      MedianFilterPixel(copy.camera, copy.View(), col, row);
      EXPECT_NEAR(copy.Depth(col, row), col < 12 ? 5 : 8, 1e-5);
    }
  }
}

// So the pixels of one colour can be filtered at the same time.
TEST(MedianFilter, ReadsOnlyTheOtherColour) {
  Field field = Noisy(3);
  Field changed = field;
  for (int row = 0; row < kHeight; ++row) {
    for (int col = row % 2; col < kWidth; col += 2) {
      if (col != 10 || row != 8) changed.Set(col, row, 1, kFacing);
    }
  }
  MedianFilterPixel(field.camera, field.View(), 10, 8);
  MedianFilterPixel(changed.camera, changed.View(), 10, 8);
  EXPECT_EQ(field.Depth(10, 8), changed.Depth(10, 8));
}

}  // namespace
}  // namespace hpm
