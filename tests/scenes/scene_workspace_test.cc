#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/formats/patch_match_cfg.h"
#include "colmap_plugin/formats/sparse_model.h"
#include "tests/scenes/workspace_writer.h"

#include <memory>

#include <gtest/gtest.h>

namespace hpm {
namespace {

class SceneWorkspace : public testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(testing::TempDir()) /
              testing::UnitTest::GetInstance()->current_test_info()->name();
    std::filesystem::remove_all(folder_);
    SceneOptions options;
    options.num_views = 3;
    options.width = 40;
    options.height = 30;
    options.quarter_turns = {0, 1, 0};
    scene_ = std::make_unique<TestScene>(MakeTiltedPlane(options));
    views_ = WriteWorkspace(*scene_, folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path folder_;
  std::unique_ptr<TestScene> scene_;
  std::vector<RenderedView> views_;
};

TEST_F(SceneWorkspace, SparseModelHoldsTheCamerasOfTheScene) {
  const SparseModel model = ReadSparseModel(folder_ / "sparse");
  ASSERT_EQ(model.images.size(), 3u);
  for (int i = 0; i < 3; ++i) {
    const SparseImage& image = model.images[i];
    const Camera& camera = scene_->cameras[i];
    EXPECT_EQ(image.name, ViewName(i));
    const SparseCamera& intrinsics = model.cameras.at(image.camera_id);
    EXPECT_EQ(intrinsics.model, "PINHOLE");
    EXPECT_EQ(intrinsics.params[0], camera.fx);
    EXPECT_EQ(intrinsics.params[2], camera.cx + 0.5);
    const Eigen::Matrix3d rotation =
        image.cam_from_world_rotation.toRotationMatrix();
    for (int k = 0; k < 9; ++k)
      EXPECT_NEAR(rotation(k / 3, k % 3), camera.R.m[k], 1e-6);
    EXPECT_EQ(image.cam_from_world_translation.z(), camera.t.z);
  }
}

TEST_F(SceneWorkspace, SparsePointsLieOnTheSurfaceInEveryImageOfTheirTrack) {
  const SparseModel model = ReadSparseModel(folder_ / "sparse");
  ASSERT_GT(model.points.size(), 300u);
  for (size_t i = 0; i < model.points.size(); ++i) {
    const SparsePoint point = model.points[i];
    ASSERT_GE(point.track.size(), 2u);
    for (const int index : point.track) {
      const Camera& camera = scene_->cameras[index];
      const Eigen::Vector3f p = point.xyz.cast<float>();
      const Vec3f in_camera = CamFromWorld(camera, {p.x(), p.y(), p.z()});
      const auto hit = HitAt(*scene_,
                             camera,
                             camera.fx * in_camera.x / in_camera.z + camera.cx,
                             camera.fy * in_camera.y / in_camera.z + camera.cy);
      ASSERT_TRUE(hit);
      EXPECT_NEAR(hit->t, in_camera.z, 1e-4);
    }
  }
}

TEST_F(SceneWorkspace, ConfigurationNamesEveryView) {
  const auto entries =
      ReadPatchMatchCfg(folder_ / "stereo/patch-match.cfg").entries;
  ASSERT_EQ(entries.size(), 3u);
  EXPECT_EQ(entries[2].ref_name, ViewName(2));
  EXPECT_EQ(entries[2].sources, PatchMatchCfgEntry::Sources::kAuto);
  EXPECT_EQ(entries[2].max_num_auto, 20);
  EXPECT_TRUE(std::filesystem::exists(folder_ / "images" / ViewName(2)));
  EXPECT_TRUE(std::filesystem::is_directory(folder_ / "stereo/depth_maps"));
}

TEST_F(SceneWorkspace, GroundTruthFilesHoldTheTrueMaps) {
  const Map depth = ReadMap(folder_ / "gt/depth_maps" / (ViewName(1) + ".bin"));
  EXPECT_EQ(depth.data, views_[1].truth.depth);
  const Map normals =
      ReadMap(folder_ / "gt/normal_maps" / (ViewName(1) + ".bin"));
  ASSERT_EQ(normals.channels, 3);
  EXPECT_EQ(normals.data[2 * 40 * 30 + 7], views_[1].truth.normals[7].z);
}

// COLMAP's fusion puts the depth of (col, row) on the ray K^-1 (col, row, 1) of
// the sparse model's K; the true surface must pass there.
TEST_F(SceneWorkspace, TruthAsMapsFollowsColmapsIntegerRule) {
  WriteTruthAsMaps(*scene_, folder_, "geometric");
  const auto& plane = std::get<PlaneSurface>(scene_->surfaces[0]);
  for (int i = 0; i < 3; ++i) {
    const Map depth = ReadMap(folder_ / "stereo/depth_maps" /
                              (ViewName(i) + ".geometric.bin"));
    Camera camera = scene_->cameras[i];
    camera.cx += 0.5f;
    camera.cy += 0.5f;
    for (int row = 0; row < depth.height; ++row) {
      for (int col = 0; col < depth.width; ++col) {
        const float z =
            depth.data[static_cast<size_t>(row) * depth.width + col];
        const Vec3f p = WorldFromCam(
            camera,
            z * RayAt(
                    camera, static_cast<float>(col), static_cast<float>(row)));
        EXPECT_NEAR(
            plane.normal.dot(Eigen::Vector3d(p.x, p.y, p.z) - plane.point),
            0,
            1e-5);
      }
    }
  }
}

}  // namespace
}  // namespace hpm
