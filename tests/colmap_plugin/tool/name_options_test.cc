#include "colmap_plugin/tool/name_options.h"

#include "colmap_plugin/options/option_table.h"
#include "src/base/remedies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(NameOptions, AddsTheOptionBehindTheRemedy) {
  EXPECT_EQ(NameOptions("no memory; use smaller images, or fewer sources"),
            "no memory; use smaller images (--PatchMatchStereo.max_image_size),"
            " or fewer sources");
  EXPECT_EQ(NameOptions("all is well"), "all is well");
}

TEST(NameOptions, EveryRemedyHasAnOptionThatExists) {
  for (const char* remedy : {kSmallerImages,
                             kFewerThreads,
                             kFewerImagesAtOnce,
                             kComputeOnCpu,
                             kCpuTarget}) {
    const std::string named = NameOptions(remedy);
    const size_t begin = named.find("(--");
    ASSERT_NE(begin, std::string::npos) << remedy;
    const size_t end = named.find_first_of(" )", begin);
    EXPECT_NE(FindOption(named.substr(begin + 3, end - begin - 3)), nullptr)
        << named;
  }
}

}  // namespace
}  // namespace hpm
