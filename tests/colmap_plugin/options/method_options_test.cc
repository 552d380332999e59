#include "colmap_plugin/options/method_options.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(MethodOptions, SpatialSigmaFollowsTheWindowUnlessGiven) {
  ControllerOptions options;
  options.patch_match.window_radius = 7;
  EXPECT_EQ(MakeMethodParams(options).patch_radius, 7);
  EXPECT_EQ(MakeMethodParams(options).sigma_spatial, 7);
  options.patch_match.sigma_spatial = 3;
  EXPECT_EQ(MakeMethodParams(options).sigma_spatial, 3);
}

TEST(MethodOptions, DefaultsAreThePapersNotColmaps) {
  const MethodParams params = MakeMethodParams(ControllerOptions());
  EXPECT_EQ(params.sigma_color, 3);  // grey levels of 255
  EXPECT_EQ(params.num_view_draws, 15);
  EXPECT_FLOAT_EQ(params.geom_weight, 0.1f);
  EXPECT_EQ(params.geom_max_error, 5);
}

TEST(MethodOptions, NumbersThatAreNotGivenAreTheMethodsOwn) {
  ControllerOptions options;
  EXPECT_EQ(MakeScheduleOptions(options).num_iterations, 3);
  EXPECT_EQ(MakeMethodParams(options).max_views, 4);
  EXPECT_EQ(MakeMethodParams(options).cut_color, 15);
  options.hpm.method = "hpm";
  EXPECT_EQ(MakeMethodParams(options).max_views, kMaxViews);
  EXPECT_EQ(MakeMethodParams(options).cut_color, 0);
  options.hpm.max_views = 3;
  options.hpm.num_iterations = 0;
  EXPECT_EQ(MakeMethodParams(options).max_views, 3);
  EXPECT_EQ(MakeScheduleOptions(options).num_iterations, 3);
}

TEST(MethodOptions, WithoutGeometricConsistencyThereAreNoGeometricPasses) {
  ControllerOptions options;
  options.hpm.num_geom_passes = 3;
  EXPECT_EQ(MakeScheduleOptions(options).num_geom_passes, 3);
  options.patch_match.geom_consistency = false;
  EXPECT_EQ(MakeScheduleOptions(options).num_geom_passes, 0);
}

TEST(MethodOptions, FilterAngleIsInRadians) {
  ControllerOptions options;
  options.patch_match.filter_min_triangulation_angle = 90;
  const std::optional<MapFilter> filter = MakeMapFilter(options);
  ASSERT_TRUE(filter);
  EXPECT_NEAR(filter->params.min_triangulation_angle, 1.5707963, 1e-6);
}

TEST(MethodOptions, WithoutFilterThereIsNone) {
  ControllerOptions options;
  options.patch_match.filter = false;
  EXPECT_FALSE(MakeMapFilter(options));
}

}  // namespace
}  // namespace hpm
