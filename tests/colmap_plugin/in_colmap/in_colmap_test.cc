// The glue, with stand-ins for COLMAP's headers.
#include "colmap_plugin/in_colmap/patch_match_controller.h"
#include "src/base/error.h"
#include "tests/base/scratch_folder.h"

#include <gtest/gtest.h>

namespace colmap {
namespace mvs {
namespace {

// Reading the workspace, here an empty one, and planning tell no progress.
TEST(HpmPatchMatchController, AsksWhetherToStopBeforeAnyProgress) {
  const hpm::ScratchFolder folder;
  HpmPatchMatchController controller(
      {}, folder.path().string(), "COLMAP", "option-all");
  controller.Stop();
  try {
    controller.Run();
  } catch (const hpm::Error& error) {
    EXPECT_EQ(error.code(), hpm::ErrorCode::kBadInput);
  }
  EXPECT_GT(controller.num_asked(), 0);
}

}  // namespace
}  // namespace mvs
}  // namespace colmap
