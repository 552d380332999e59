#include "colmap_plugin/options/option_record.h"

#include "colmap_plugin/options/option_table.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(OptionRecord, HoldsEveryOptionThatHasAnEffect) {
  const nlohmann::json record = OptionRecord(ControllerOptions());
  for (const OptionSpec& option : OptionTable())
    EXPECT_EQ(record.count(option.name), option.no_effect.empty())
        << option.name;
}

TEST(OptionRecord, HoldsValuesOfTheirTypeAsTheyTookEffect) {
  ControllerOptions options;
  options.workspace.path = "dense";
  options.workspace.max_image_size = 200;
  options.hpm.geom_weight = 0.25;
  const nlohmann::json record = OptionRecord(options);
  EXPECT_EQ(record["workspace_path"], "dense");
  EXPECT_EQ(record["PatchMatchStereo.max_image_size"], 200);
  EXPECT_EQ(record["PatchMatchStereo.filter"], true);
  EXPECT_EQ(record["Hpm.method"], kDefaultMethod);
  EXPECT_EQ(record["Hpm.geom_weight"], 0.25);
  EXPECT_EQ(record["Hpm.num_iterations"],
            FindMethod(kDefaultMethod).numbers.num_iterations);
}

}  // namespace
}  // namespace hpm
