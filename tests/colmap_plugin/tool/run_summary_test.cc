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
  summary.peak_memory_bytes = uint64_t{3} << 29;
  summary.cpu_target = "AVX2";
  EXPECT_EQ(SummaryLines(options, summary),
            (std::vector<std::string>{
                "12 images: 7 computed, 4 kept from an earlier run, 1 failed",
                "Pixels with a depth: 62.5 %",
                "Time 3 min 20 s, peak memory 1.50 GiB, AVX2",
                "Maps: /data/dense/stereo/depth_maps and "
                "/data/dense/stereo/normal_maps",
                "Next: colmap stereo_fusion --workspace_path /data/dense "
                "--input_type geometric "
                "--output_path /data/dense/fused.ply"}));
}

TEST(RunSummaryTest, NamesThePhotometricMapsWithoutGeometricPasses) {
  ControllerOptions options;
  options.patch_match.geom_consistency = false;
  EXPECT_THAT(SummaryLines(options, {}),
              Contains(HasSubstr("--input_type photometric")));
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
