#include "colmap_plugin/tool/run_summary.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;

TEST(RunSummaryTest, TellsWhatWasDoneAndWhatComesNext) {
  ControllerOptions options;
  options.workspace.path = "/data/dense";
  RunSummary summary;
  summary.num_problems = 12;
  summary.num_computed = 7;
  summary.num_kept = 4;
  summary.failed = {"a.jpg"};
  summary.seconds = 200;
  summary.valid_pixel_share = 0.625;
  summary.filter_losses = {{FilterCriterion::kFacing, 1e-5},
                           {FilterCriterion::kAngle, 0.3},
                           {FilterCriterion::kNumConsistent, 0.075}};
  summary.num_fusable = 11;
  summary.peak_memory_bytes = uint64_t{3} << 29;
  summary.backend = "AVX2";
  EXPECT_EQ(SummaryLines(options, summary),
            (std::vector<std::string>{
                "12 images: 7 computed, 4 kept from an earlier run, 1 failed",
                "Pixels with a depth, of the images computed now: 62.5 %",
                "Pixels dropped by: angle 30.0 %, consistent views 7.5 %",
                "Time 3 min 20 s, peak memory 1.50 GiB, AVX2",
                "Maps: /data/dense/stereo/depth_maps and "
                "/data/dense/stereo/normal_maps",
                "Next: colmap stereo_fusion --workspace_path /data/dense "
                "--input_type geometric "
                "--output_path /data/dense/fused.ply"}));
}

TEST(RunSummaryTest, TheShareIsThatOfAllWhereNothingWasKept) {
  RunSummary summary;
  summary.num_problems = summary.num_computed = 3;
  summary.valid_pixel_share = 0.5;
  EXPECT_THAT(SummaryLines({}, summary),
              Contains("Pixels with a depth: 50.0 %"));
}

TEST(RunSummaryTest, NoFusionIsNamedThatWouldFindNothing) {
  RunSummary summary;
  summary.num_problems = summary.num_computed = summary.num_fusable = 12;
  summary.fusion_finds_nothing = true;
  const std::vector<std::string> lines = SummaryLines({}, summary);
  EXPECT_THAT(lines.back(), HasSubstr("Next: triangulate"));
  EXPECT_THAT(lines, Not(Contains(HasSubstr("--output_path"))));
}

// As when a run only makes again what an earlier stage lost.
TEST(RunSummaryTest, WithoutFinalMapsThereIsNoShareOfThem) {
  RunSummary summary;
  summary.num_problems = summary.num_computed = 3;
  EXPECT_THAT(SummaryLines({}, summary),
              Not(Contains(HasSubstr("Pixels with a depth"))));
}

TEST(RunSummaryTest, NamesThePhotometricMapsWithoutGeometricPasses) {
  ControllerOptions options;
  options.patch_match.geom_consistency = false;
  EXPECT_THAT(SummaryLines(options, {}),
              Contains(HasSubstr("--input_type photometric")));
}

// With its default of 5 images per point fusion would leave nothing.
TEST(RunSummaryTest, FewImagesNeedAnOptionOfFusion) {
  RunSummary summary;
  const std::pair<int, const char*> expected[] = {{1, "min_num_pixels 1"},
                                                  {2, "min_num_pixels 2"},
                                                  {3, "min_num_pixels 2"},
                                                  {4, "min_num_pixels 3"},
                                                  {5, "min_num_pixels 4"}};
  for (const auto& [num_images, option] : expected) {
    summary.num_fusable = num_images;
    EXPECT_THAT(SummaryLines({}, summary).back(), testing::EndsWith(option));
  }
  for (const int num_images : {0, 6}) {
    summary.num_fusable = num_images;
    EXPECT_THAT(SummaryLines({}, summary),
                Not(Contains(HasSubstr("min_num_pixels"))));
  }
}

TEST(RunSummaryTest, ShareIsLeftOutWhenNothingWasComputed) {
  EXPECT_THAT(SummaryLines({}, {}), Not(Contains(HasSubstr("Pixels"))));
}

TEST(RunSummaryTest, PmvsWorkspaceHasItsOwnFolderAndFusionOptions) {
  ControllerOptions options;
  options.workspace.path = "my pmvs";
  options.workspace.format = "pmvs";
  options.workspace.pmvs_option_name = "option-0001";
  const auto lines = SummaryLines(options, {});
  EXPECT_THAT(lines,
              Contains(HasSubstr("my pmvs/stereo-option-0001/depth_maps")));
  EXPECT_THAT(
      lines,
      Contains(HasSubstr("--workspace_path 'my pmvs' --workspace_format PMVS "
                         "--pmvs_option_name option-0001")));
}

}  // namespace
}  // namespace hpm
