#include "colmap_plugin/workspace/file_system.h"

#include "src/base/platform/processes.h"
#include "tests/base/scratch_folder.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(UnsyncedSince, IsTheRunningKernelOnALocalDisk) {
  const ScratchFolder folder;
  EXPECT_EQ(UnsyncedSince(folder.path()), BootId());
}

// /proc is none of the disks that are known as local.
TEST(UnsyncedSince, IsEmptyWhereTheKernelSaysNothing) {
  EXPECT_EQ(UnsyncedSince("/proc"), "");
  EXPECT_EQ(UnsyncedSince("/none"), "");
}

}  // namespace
}  // namespace hpm
