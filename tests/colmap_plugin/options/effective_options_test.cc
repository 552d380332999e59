#include "colmap_plugin/options/effective_options.h"

#include "src/base/error.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(EffectiveOptions, NumbersThatAreNotGivenAreTheMethodsOwn) {
  const MethodNumbers& own = FindMethod(kDefaultMethod).numbers;
  for (const int none : {-1, 0}) {
    ControllerOptions options;
    options.hpm.num_iterations = none;
    options.hpm.num_geom_passes = none;
    options.hpm.max_views = none;
    const HpmOptions effective = EffectiveOptions(options).hpm;
    EXPECT_EQ(effective.num_iterations, own.num_iterations);
    EXPECT_EQ(effective.num_geom_iterations, own.num_geom_iterations);
    EXPECT_EQ(effective.num_geom_passes, own.num_geom_passes);
    EXPECT_EQ(effective.num_fine_iterations, own.num_fine_iterations);
    EXPECT_EQ(effective.num_fine_geom_passes, own.num_fine_geom_passes);
    EXPECT_EQ(effective.max_views, own.max_views);
  }
}

TEST(EffectiveOptions, NumbersThatAreGivenStay) {
  ControllerOptions options;
  options.hpm.num_iterations = 7;
  options.hpm.num_fine_iterations = 0;  // none at all
  options.hpm.max_views = 3;
  options.patch_match.sigma_spatial = 3;
  const ControllerOptions effective = EffectiveOptions(options);
  EXPECT_EQ(effective.hpm.num_iterations, 7);
  EXPECT_EQ(effective.hpm.num_fine_iterations, 0);
  EXPECT_EQ(effective.hpm.max_views, 3);
  EXPECT_EQ(effective.patch_match.sigma_spatial, 3);
}

TEST(EffectiveOptions, SpatialSigmaFollowsTheWindow) {
  ControllerOptions options;
  options.patch_match.window_radius = 7;
  EXPECT_EQ(EffectiveOptions(options).patch_match.sigma_spatial, 7);
}

TEST(EffectiveOptions, CriteriaOfAFilterThatIsOffHaveNoSay) {
  ControllerOptions options;
  options.patch_match.filter_min_ncc = 0.5;
  options.hpm.filter_min_agreement = 0;
  EXPECT_EQ(EffectiveOptions(options).patch_match.filter_min_ncc, 0.5);
  options.patch_match.filter = false;
  const ControllerOptions effective = EffectiveOptions(options);
  EXPECT_EQ(effective.patch_match.filter_min_ncc,
            PatchMatchStereoOptions().filter_min_ncc);
  EXPECT_EQ(effective.hpm.filter_min_agreement,
            HpmOptions().filter_min_agreement);
}

TEST(EffectiveOptions, UnknownMethodsAreRefused) {
  ControllerOptions options;
  options.hpm.method = "hmp";
  EXPECT_THROW(EffectiveOptions(options), Error);
}

}  // namespace
}  // namespace hpm
