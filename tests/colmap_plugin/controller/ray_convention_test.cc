#include "colmap_plugin/controller/ray_convention.h"

#include "tests/colmap_plugin/controller/written_maps.h"

#include <cmath>
#include <random>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kWidth = 31;
constexpr int kHeight = 23;

const Camera kCamera = {kWidth,
                        kHeight,
                        40,
                        42,
                        14.5f,
                        11.25f,
                        {{0, -1, 0, 1, 0, 0, 0, 0, 1}},
                        {0.3f, -0.2f, 0.7f}};

// K as in the sparse model: pixel centres at +0.5.
Camera SparseModelCamera() {
  Camera camera = kCamera;
  camera.cx += 0.5f;
  camera.cy += 0.5f;
  return camera;
}

HypothesisMap RandomPlanes() {
  std::mt19937 random(1);
  const auto uniform = [&](float lo, float hi) {
    return lo + (hi - lo) * static_cast<float>(random() / 4294967296.0);
  };
  HypothesisMap map(kWidth, kHeight);
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      map.planes[row * kWidth + col] = PlaneFromDepth(
          kCamera,
          static_cast<float>(col),
          static_cast<float>(row),
          uniform(1, 9),
          Normalized({uniform(-0.6f, 0.6f), uniform(-0.6f, 0.6f), -1}));
    }
  }
  return map;
}

// What the program reads from the files it wrote.
class RayConvention : public testing::Test {
 protected:
  std::vector<Plane> Planes(const HypothesisMap& map,
                            const std::vector<bool>* keep = nullptr) {
    WriteMaps(map, kCamera, depth_path_, normal_path_, keep);
    std::vector<Plane> planes(3, Plane{{1, 1, 1}, 1});  // of a map before
    ReadPlanes(depth_path_, normal_path_, kCamera, &planes);
    return planes;
  }
  std::vector<float> InverseDepths(const HypothesisMap& map, int more_levels) {
    WriteMaps(map, kCamera, depth_path_, normal_path_);
    const InverseDepthMap inverse =
        ReadInverseDepths(depth_path_, normal_path_, kCamera, more_levels);
    std::vector<float> values(inverse.steps.size() / kInverseDepthBytes);
    for (size_t i = 0; i < values.size(); ++i) {
      values[i] = inverse.step * static_cast<float>(InverseDepthSteps(
                                     inverse.steps.data(), i));
    }
    return values;
  }

  ScratchFolder folder_;
  std::filesystem::path depth_path_ = folder_ / "depth.bin";
  std::filesystem::path normal_path_ = folder_ / "normal.bin";
};

TEST_F(RayConvention, RoundTripIsExactToRounding) {
  const HypothesisMap map = RandomPlanes();
  const std::vector<Plane> back = Planes(map);
  for (size_t i = 0; i < map.planes.size(); ++i) {
    EXPECT_EQ(Norm(back[i].normal - map.planes[i].normal), 0);
    EXPECT_NEAR(back[i].distance / map.planes[i].distance, 1, 1e-6);
  }
}

TEST_F(RayConvention, DropsDepthsOutsideARangeWithTheirNormals) {
  DepthAndNormal maps = {{2, 2, 1, {1, 2, 3, 4}},
                         {2, 2, 3, std::vector<float>(12, 0.5f)}};
  EXPECT_EQ(DropOutside({2, 3}, &maps), 2u);
  EXPECT_EQ(maps.depth.data, (std::vector<float>{0, 2, 3, 0}));
  for (size_t i = 0; i < 12; ++i)
    EXPECT_EQ(maps.normal.data[i], maps.depth.data[i % 4] > 0 ? 0.5f : 0);
}

TEST_F(RayConvention, DepthsOutsideARangeAreNotWritten) {
  HypothesisMap map = RandomPlanes();
  for (size_t i = 0; i < map.costs.size(); ++i)
    map.costs[i] = 0.1f * static_cast<float>(i % 20) + 0.05f;
  const DepthAndNormal all = WrittenMaps(map, kCamera);
  const WrittenDepths written =
      WriteMaps(map, kCamera, depth_path_, normal_path_, nullptr, {3, 5});
  const Map depth = ReadMap(depth_path_), normal = ReadMap(normal_path_);
  const size_t size = depth.data.size();
  size_t num_valid = 0;
  CostHistogram costs;
  for (size_t i = 0; i < size; ++i) {
    const bool inside = all.depth.data[i] >= 3 && all.depth.data[i] <= 5;
    num_valid += inside;
    if (inside) costs.Add(map.costs[i]);
    EXPECT_EQ(depth.data[i], inside ? all.depth.data[i] : 0);
    EXPECT_EQ(normal.data[i] != 0, inside);
  }
  EXPECT_EQ(written.num_valid, num_valid);
  EXPECT_EQ(written.num_dropped, size - num_valid);
  EXPECT_EQ(written.costs.bins, costs.bins);
}

// Several bands of rows, the last of which is not full.
TEST_F(RayConvention, ALargeMapIsWrittenAndReadAsAWhole) {
  Camera camera = kCamera;
  camera.width = 1000;
  camera.height = 101;
  HypothesisMap map(camera.width, camera.height);
  for (size_t i = 0; i < map.planes.size(); ++i) {
    map.planes[i] = {Normalized({0.01f, 0.02f, -1}),
                     1 + static_cast<float>(i % 977) / 977};
  }
  WriteMaps(map, camera, depth_path_, normal_path_);
  std::vector<Plane> back;
  ReadPlanes(depth_path_, normal_path_, camera, &back);
  ASSERT_EQ(back.size(), map.planes.size());
  for (size_t i = 0; i < back.size(); ++i)
    ASSERT_NEAR(back[i].distance, map.planes[i].distance, 1e-5) << i;
}

TEST_F(RayConvention, RoundTripsDoNotDrift) {
  HypothesisMap map = RandomPlanes();
  const HypothesisMap first = map;
  for (int i = 0; i < 20; ++i) {
    map.planes = Planes(map);
  }
  for (size_t i = 0; i < map.planes.size(); ++i) {
    EXPECT_NEAR(map.planes[i].distance / first.planes[i].distance, 1, 5e-6);
  }
}

// Fusion puts the value of (col, row) on the ray K^-1 (col, row, 1) of the
// sparse model's K: the point must lie on the plane that was estimated.
TEST_F(RayConvention, FusionsPointsLieOnThePlane) {
  const HypothesisMap map = RandomPlanes();
  const DepthAndNormal files = WrittenMaps(map, kCamera);
  const Camera fusion = SparseModelCamera();
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const size_t i = static_cast<size_t>(row) * kWidth + col;
      const Vec3f point =
          files.depth.data[i] *
          RayAt(fusion, static_cast<float>(col), static_cast<float>(row));
      EXPECT_NEAR(
          Dot(map.planes[i].normal, point) + map.planes[i].distance, 0, 1e-5);
    }
  }
}

// One plane for the whole picture: in the world, all points lie on it.
TEST_F(RayConvention, FusedWallIsTheTrueWall) {
  const Vec3f normal = Normalized({0.3f, -0.2f, -1});
  HypothesisMap map(kWidth, kHeight);
  const Plane wall = PlaneFromDepth(kCamera, 10, 10, 5, normal);
  for (Plane& plane : map.planes) plane = wall;
  const Map depth = WrittenMaps(map, kCamera).depth;
  const Camera fusion = SparseModelCamera();
  // In the world frame: n_w . X + d_w = 0.
  const Vec3f n_world = Transposed(kCamera.R) * normal;
  const float d_world = wall.distance + Dot(normal, kCamera.t);
  for (int row = 0; row < kHeight; ++row) {
    for (int col = 0; col < kWidth; ++col) {
      const Vec3f point = WorldFromCam(
          fusion,
          depth.data[static_cast<size_t>(row) * kWidth + col] *
              RayAt(fusion, static_cast<float>(col), static_cast<float>(row)));
      EXPECT_NEAR(Dot(n_world, point) + d_world, 0, 1e-5);
    }
  }
}

TEST_F(RayConvention, NormalsAreStoredPlaneByPlane) {
  const HypothesisMap map = RandomPlanes();
  const DepthAndNormal files = WrittenMaps(map, kCamera);
  ASSERT_EQ(files.depth.channels, 1);
  ASSERT_EQ(files.normal.channels, 3);
  const size_t size = map.planes.size();
  ASSERT_EQ(files.normal.data.size(), 3 * size);
  EXPECT_EQ(files.normal.data[77], map.planes[77].normal.x);
  EXPECT_EQ(files.normal.data[size + 77], map.planes[77].normal.y);
  EXPECT_EQ(files.normal.data[2 * size + 77], map.planes[77].normal.z);
}

// Also in the partial blocks at the right and lower border.
TEST_F(RayConvention,
       HalvedInverseDepthsArePlanesAtTheCentresOfTheCoarsePixels) {
  HypothesisMap map(kWidth, kHeight);
  const Plane wall =
      PlaneFromDepth(kCamera, 10, 10, 5, Normalized({0.3f, -0.2f, -1}));
  for (Plane& plane : map.planes) plane = wall;
  for (int level = 0; level < 4; ++level) {
    const Camera coarse = LevelCamera(kCamera, level);
    const std::vector<float> inverse = InverseDepths(map, level);
    ASSERT_EQ(inverse.size(),
              static_cast<size_t>(coarse.width) * coarse.height);
    for (int row = 0; row < coarse.height; ++row) {
      for (int col = 0; col < coarse.width; ++col) {
        const float z = DepthAt(
            coarse, wall, static_cast<float>(col), static_cast<float>(row));
        EXPECT_NEAR(inverse[static_cast<size_t>(row) * coarse.width + col] * z,
                    1,
                    1e-5);
      }
    }
  }
}

TEST_F(RayConvention, HolesOfInverseDepthsStayHoles) {
  HypothesisMap map = RandomPlanes();
  const Camera coarse = LevelCamera(kCamera, 1);
  for (int row = 4; row < 6; ++row) {
    for (int col = 6; col < 8; ++col)
      map.planes[row * kWidth + col] = {{0, 0, 0}, 0};
  }
  const std::vector<float> inverse = InverseDepths(map, 1);
  for (size_t i = 0; i < inverse.size(); ++i) {
    EXPECT_EQ(inverse[i] > 0, i != static_cast<size_t>(2 * coarse.width + 3))
        << i;
  }
}

TEST_F(RayConvention, PixelsNotKeptOrWithoutAPlaneAreZero) {
  HypothesisMap map = RandomPlanes();
  map.planes[5] = {{0, 0, 0}, 0};
  std::vector<bool> keep(map.planes.size(), true);
  keep[7] = false;
  const DepthAndNormal files = WrittenMaps(map, kCamera, &keep);
  const std::vector<Plane> back = Planes(map, &keep);
  const size_t size = map.planes.size();
  for (const size_t i : {size_t{5}, size_t{7}}) {
    EXPECT_EQ(files.depth.data[i], 0);
    for (int channel = 0; channel < 3; ++channel) {
      EXPECT_EQ(files.normal.data[channel * size + i], 0);
    }
    EXPECT_EQ(back[i].distance, 0);
  }
  EXPECT_GT(files.depth.data[6], 0);
}

// Seen nearly edge-on a plane may meet the ray of the pixel's centre but not
// the one half a pixel beside it.
TEST_F(RayConvention, PlaneThatMissesColmapsRayBecomesZero) {
  HypothesisMap map = RandomPlanes();
  const Vec3f ray = RayAt(kCamera, 20, 10);
  const Vec3f other = RayAt(kCamera, 19.75f, 10);
  Vec3f edge_on = Normalized(Cross(Cross(ray, other), other));
  if (Dot(edge_on, ray) > 0) edge_on = -edge_on;
  map.planes[10 * kWidth + 20] = PlaneFromDepth(kCamera, 20, 10, 5, edge_on);
  const DepthAndNormal files = WrittenMaps(map, kCamera);
  EXPECT_EQ(files.depth.data[10 * kWidth + 20], 0);
  EXPECT_EQ(files.normal.data[10 * kWidth + 20], 0);
}

TEST_F(RayConvention, NonFinitePlanesBecomeZero) {
  HypothesisMap map = RandomPlanes();
  map.planes[3] = {{NAN, 0, -1}, 1};
  map.planes[4] = {{0, 0, -1}, INFINITY};
  map.planes[5] = {{0, 0, -1}, NAN};
  const DepthAndNormal files = WrittenMaps(map, kCamera);
  for (const int i : {3, 4, 5}) EXPECT_EQ(files.depth.data[i], 0);
}

}  // namespace
}  // namespace hpm
