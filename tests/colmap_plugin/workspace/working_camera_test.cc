#include "colmap_plugin/workspace/working_camera.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInf = std::numeric_limits<double>::infinity();

SparseImage ImageAtOrigin() {
  SparseImage image;
  image.name = "a.jpg";
  image.cam_from_world_rotation = Eigen::Quaterniond::Identity();
  image.cam_from_world_translation = Eigen::Vector3d::Zero();
  return image;
}

SparseCamera Pinhole(uint64_t width, uint64_t height) {
  return {"PINHOLE", width, height, {100, 110, 80, 60}};
}

std::optional<Camera> Make(
    const SparseCamera& camera,
    const SparseImage& image = ImageAtOrigin(),
    const std::optional<ImageSize>& file_size = std::nullopt,
    int max_image_size = -1) {
  std::string why_not;
  const auto made =
      MakeWorkingCamera(camera, image, file_size, max_image_size, &why_not);
  EXPECT_EQ(made.has_value(), why_not.empty()) << why_not;
  return made;
}

std::string WhyNot(const SparseCamera& camera,
                   const SparseImage& image = ImageAtOrigin()) {
  std::string why_not;
  EXPECT_FALSE(MakeWorkingCamera(camera, image, std::nullopt, -1, &why_not));
  return why_not;
}

TEST(WorkingCamera, KeepsIntrinsicsButForHalfAPixel) {
  const auto camera = Make(Pinhole(160, 120));
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 160);
  EXPECT_EQ(camera->height, 120);
  EXPECT_EQ(camera->fx, 100);
  EXPECT_EQ(camera->fy, 110);
  EXPECT_EQ(camera->cx, 79.5f);
  EXPECT_EQ(camera->cy, 59.5f);
}

TEST(WorkingCamera, HasTheModelsAxesAroundItsCentre) {
  SparseImage image = ImageAtOrigin();
  // A quarter turn about z: x goes to y.
  image.cam_from_world_rotation =
      Eigen::Quaterniond(std::sqrt(0.5), 0, 0, std::sqrt(0.5));
  image.cam_from_world_translation = Eigen::Vector3d(1, 2, 3);
  const auto camera = Make(Pinhole(160, 120), image);
  ASSERT_TRUE(camera);
  const Vec3f point = CamFromWorld(*camera, {1, 0, 0});
  EXPECT_NEAR(point.x, 0, 1e-6);
  EXPECT_NEAR(point.y, 1, 1e-6);
  EXPECT_NEAR(point.z, 0, 1e-6);
}

TEST(WorkingCamera, MaxImageSizeScalesEachAxisToWholePixels) {
  // Factor min(100/161, 100/120) = 100/161; 120 * 100/161 = 74.53 -> 75.
  const auto camera =
      Make(Pinhole(161, 120), ImageAtOrigin(), std::nullopt, 100);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 100);
  EXPECT_EQ(camera->height, 75);
  EXPECT_FLOAT_EQ(camera->fx, 100 * 100.f / 161);
  EXPECT_FLOAT_EQ(camera->fy, 110 * 75.f / 120);
  EXPECT_FLOAT_EQ(camera->cx, 80 * 100.f / 161 - 0.5f);
  EXPECT_FLOAT_EQ(camera->cy, 60 * 75.f / 120 - 0.5f);
}

TEST(WorkingCamera, ImagesNeverGrow) {
  const auto camera =
      Make(Pinhole(160, 120), ImageAtOrigin(), std::nullopt, 160);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 160);
  EXPECT_EQ(camera->cx, 79.5f);
}

TEST(WorkingCamera, NoSideIsRoundedToZero) {
  const auto camera =
      Make(Pinhole(10000, 1), ImageAtOrigin(), std::nullopt, 100);
  ASSERT_TRUE(camera);
  EXPECT_EQ(camera->width, 100);
  EXPECT_EQ(camera->height, 1);
}

TEST(WorkingCamera, FollowsTheSizeOfTheFileBeforeTheLimit) {
  const auto shrunk =
      Make(Pinhole(160, 120), ImageAtOrigin(), ImageSize{100, 75});
  ASSERT_TRUE(shrunk);
  EXPECT_EQ(shrunk->width, 100);
  EXPECT_EQ(shrunk->height, 75);
  EXPECT_FLOAT_EQ(shrunk->fx, 62.5f);
  EXPECT_FLOAT_EQ(shrunk->fy, 68.75f);
  EXPECT_FLOAT_EQ(shrunk->cx, 49.5f);
  EXPECT_FLOAT_EQ(shrunk->cy, 37.f);

  const auto limited =
      Make(Pinhole(160, 120), ImageAtOrigin(), ImageSize{100, 75}, 50);
  ASSERT_TRUE(limited);
  EXPECT_EQ(limited->width, 50);
  EXPECT_EQ(limited->height, 38);
  EXPECT_FLOAT_EQ(limited->fx, 31.25f);
  EXPECT_FLOAT_EQ(limited->cx, 24.5f);
}

TEST(WorkingCamera, AcceptsEveryPinholeModelWithoutDistortion) {
  const std::vector<SparseCamera> cameras = {
      {"SIMPLE_PINHOLE", 160, 120, {100, 80, 60}},
      {"PINHOLE", 160, 120, {100, 100, 80, 60}},
      {"SIMPLE_RADIAL", 160, 120, {100, 80, 60, 1e-8}},
      {"RADIAL", 160, 120, {100, 80, 60, 0, -1e-8}},
      {"OPENCV", 160, 120, {100, 100, 80, 60, 0, 0, 0, 0}},
      {"FULL_OPENCV", 160, 120, {100, 100, 80, 60, 0, 0, 0, 0, 0, 0, 0, 0}},
      {"FOV", 160, 120, {100, 100, 80, 60, 0}},
      {"SIMPLE_DIVISION", 160, 120, {100, 80, 60, 0}},
      {"DIVISION", 160, 120, {100, 100, 80, 60, 0}}};
  for (const SparseCamera& sparse_camera : cameras) {
    const auto camera = Make(sparse_camera);
    ASSERT_TRUE(camera) << sparse_camera.model;
    EXPECT_EQ(camera->fx, 100) << sparse_camera.model;
    EXPECT_EQ(camera->fy, 100) << sparse_camera.model;
    EXPECT_EQ(camera->cx, 79.5f) << sparse_camera.model;
    EXPECT_EQ(camera->cy, 59.5f) << sparse_camera.model;
  }
}

TEST(WorkingCamera, RefusesDistortionWithModelAndRemedy) {
  const std::vector<SparseCamera> cameras = {
      {"SIMPLE_RADIAL", 160, 120, {100, 80, 60, 1.1e-8}},
      {"RADIAL", 160, 120, {100, 80, 60, 0, -0.1}},
      {"OPENCV", 160, 120, {100, 100, 80, 60, 0, 0, 0, kNan}},
      {"OPENCV_FISHEYE", 160, 120, {100, 100, 80, 60, 0, 0, 0, 0}},
      {"SIMPLE_FISHEYE", 160, 120, {100, 80, 60}},
      {"EQUIRECTANGULAR", 160, 120, {}}};
  for (const SparseCamera& camera : cameras) {
    EXPECT_THAT(WhyNot(camera), testing::HasSubstr(camera.model));
    EXPECT_THAT(WhyNot(camera), testing::HasSubstr("image_undistorter"));
  }
}

TEST(WorkingCamera, RefusesNumbersThatAreNoCamera) {
  for (const double bad : {0.0, -100.0, kNan, kInf, 1e-60, 1e60}) {
    EXPECT_NE(WhyNot({"PINHOLE", 160, 120, {bad, 100, 80, 60}}), "") << bad;
    EXPECT_NE(WhyNot({"PINHOLE", 160, 120, {100, bad, 80, 60}}), "") << bad;
  }
  for (const double bad : {kNan, kInf, 1e60}) {
    EXPECT_NE(WhyNot({"PINHOLE", 160, 120, {100, 100, bad, 60}}), "") << bad;
    SparseImage image = ImageAtOrigin();
    image.cam_from_world_translation.y() = bad;
    EXPECT_NE(WhyNot(Pinhole(160, 120), image), "") << bad;
  }
  for (const double bad : {0.0, kNan, kInf}) {
    SparseImage image = ImageAtOrigin();
    image.cam_from_world_rotation.coeffs().setConstant(bad);
    EXPECT_NE(WhyNot(Pinhole(160, 120), image), "") << bad;
  }
}

TEST(WorkingCamera, RefusesImpossibleSizesAndParameterCounts) {
  EXPECT_NE(WhyNot(Pinhole(0, 120)), "");
  EXPECT_NE(WhyNot(Pinhole(160, uint64_t{1} << 63)), "");
  EXPECT_NE(WhyNot(Pinhole(1 << 20, 1 << 20)), "");
  EXPECT_NE(WhyNot({"PINHOLE", 160, 120, {100, 80, 60}}), "");
  EXPECT_NE(WhyNot({"PINHOLE", 160, 120, {}}), "");
}

}  // namespace
}  // namespace hpm
