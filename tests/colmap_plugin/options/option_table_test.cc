#include "colmap_plugin/options/option_table.h"

#include "colmap_plugin/tool/parse_options.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::Contains;
using testing::HasSubstr;

struct Expected {
  std::string name;
  std::string default_38;  // as COLMAP 3.8 prints it; "-": not an option of 3.8
  std::string
      default_new;  // as COLMAP 4.x prints it; "-": not an option of 4.x
};

// The lists of `colmap patch_match_stereo --help`, of both versions.
const std::vector<Expected>& ColmapOptions() {
  static const std::vector<Expected> options = {
      {"random_seed", "0", "-"},
      {"default_random_seed", "-", "0"},
      {"log_to_stderr", "0", "-"},
      {"log_target", "-", "stderr_and_file"},
      {"log_path", "-", ""},
      {"log_severity", "-", "0"},
      {"log_color", "-", "1"},
      {"project_path", "", ""},
      {"workspace_path", "", ""},
      {"workspace_format", "COLMAP", "COLMAP"},
      {"pmvs_option_name", "option-all", "option-all"},
      {"config_path", "", ""},
      {"PatchMatchStereo.max_image_size", "-1", "-1"},
      {"PatchMatchStereo.gpu_index", "-1", "-1"},
      {"PatchMatchStereo.depth_min", "-1", "-1"},
      {"PatchMatchStereo.depth_max", "-1", "-1"},
      {"PatchMatchStereo.window_radius", "5", "5"},
      {"PatchMatchStereo.window_step", "1", "1"},
      {"PatchMatchStereo.sigma_spatial", "-1", "-1"},
      {"PatchMatchStereo.sigma_color", "0.20000000298023224", "0.2"},
      {"PatchMatchStereo.num_samples", "15", "15"},
      {"PatchMatchStereo.ncc_sigma", "0.60000002384185791", "0.6"},
      {"PatchMatchStereo.min_triangulation_angle", "1", "1"},
      {"PatchMatchStereo.incident_angle_sigma", "0.89999997615814209", "0.9"},
      {"PatchMatchStereo.num_iterations", "5", "5"},
      {"PatchMatchStereo.geom_consistency", "1", "1"},
      {"PatchMatchStereo.geom_consistency_regularizer",
       "0.30000001192092896",
       "0.3"},
      {"PatchMatchStereo.geom_consistency_max_cost", "3", "3"},
      {"PatchMatchStereo.filter", "1", "1"},
      {"PatchMatchStereo.filter_min_ncc", "0.10000000149011612", "0.1"},
      {"PatchMatchStereo.filter_min_triangulation_angle", "3", "3"},
      {"PatchMatchStereo.filter_min_num_consistent", "2", "2"},
      {"PatchMatchStereo.filter_geom_consistency_max_cost", "1", "1"},
      {"PatchMatchStereo.cache_size", "32", "32"},
      {"PatchMatchStereo.allow_missing_files", "0", "0"},
      {"PatchMatchStereo.write_consistency_graph", "0", "0"},
      {"PatchMatchStereo.num_threads", "-", "-1"},
  };
  return options;
}

TEST(OptionTableTest, EveryColmapOptionIsThereWithItsDefault) {
  for (const Expected& expected : ColmapOptions()) {
    const OptionSpec* option = FindOption(expected.name);
    ASSERT_NE(option, nullptr) << expected.name;
    if (expected.default_new != "-") {
      EXPECT_EQ(DefaultText(*option), expected.default_new);
    }
    if (expected.default_38 == "-") continue;
    ToolOptions ours;
    ToolOptions colmaps;
    const OptionMember member = option->member(&colmaps);
    ASSERT_TRUE(ParseValue(expected.default_38, member)) << expected.name;
    if (TypeText(*option) == "float") {
      // The exact value: COLMAP widens float constants.
      EXPECT_EQ(*std::get<double*>(option->member(&ours)),
                *std::get<double*>(member));
    } else {
      EXPECT_EQ(FormatValue(option->member(&ours)), FormatValue(member))
          << expected.name;
    }
  }
  // 0 in 4.x, 2 in 3.8.
  ASSERT_NE(FindOption("log_level"), nullptr);
  EXPECT_EQ(DefaultText(*FindOption("log_level")), "0");
}

TEST(OptionTableTest, HoldsNothingButColmapsAndHpmOptions) {
  std::set<std::string> names = {"log_level"};
  for (const Expected& expected : ColmapOptions()) names.insert(expected.name);
  for (const OptionSpec& option : OptionTable()) {
    if (option.name.rfind("Hpm.", 0) != 0) {
      EXPECT_EQ(names.erase(option.name), 1u) << option.name;
    }
  }
  EXPECT_TRUE(names.empty());
}

TEST(OptionTableTest, NamesAreUniqueAndMembersDifferButForTheSeeds) {
  std::set<std::string> names;
  std::set<const void*> members;
  ToolOptions options;
  for (const OptionSpec& option : OptionTable()) {
    EXPECT_TRUE(names.insert(option.name).second) << option.name;
    const void* member =
        std::visit([](auto* value) -> const void* { return value; },
                   option.member(&options));
    if (option.name != "default_random_seed") {
      EXPECT_TRUE(members.insert(member).second) << option.name;
    }
  }
}

TEST(OptionTableTest, EveryMemberOfHpmOptionsIsAnOption) {
  // A new member breaks this line: give it a row in the table, then a name
  // here.
  const auto& [method,
               quality,
               device,
               gpu_images,
               cpu_target,
               num_iterations,
               num_geom_iterations,
               num_geom_passes,
               num_fine_iterations,
               num_fine_geom_passes,
               max_views,
               weak_gradient,
               geom_weight,
               geom_max_error,
               num_levels,
               filter_min_agreement,
               log_format,
               keep_photometric,
               report,
               confidence,
               previews,
               overwrite,
               shard,
               stage] = HpmOptions();
  (void)method, (void)device, (void)gpu_images, (void)cpu_target,
      (void)num_iterations, (void)num_geom_iterations;
  (void)num_geom_passes, (void)geom_weight, (void)geom_max_error,
      (void)num_levels, (void)filter_min_agreement;
  (void)report, (void)previews, (void)overwrite;
  (void)log_format, (void)keep_photometric;
  (void)shard, (void)stage, (void)confidence;
  (void)num_fine_iterations, (void)num_fine_geom_passes;
  (void)quality, (void)max_views, (void)weak_gradient;
  for (const char* name : {"method",
                           "quality",
                           "max_views",
                           "weak_gradient",
                           "device",
                           "gpu_images",
                           "cpu_target",
                           "num_iterations",
                           "num_geom_iterations",
                           "num_geom_passes",
                           "num_fine_iterations",
                           "num_fine_geom_passes",
                           "geom_weight",
                           "geom_max_error",
                           "num_levels",
                           "filter_min_agreement",
                           "log_format",
                           "keep_photometric",
                           "report",
                           "confidence",
                           "previews",
                           "overwrite",
                           "shard",
                           "stage"}) {
    EXPECT_NE(FindOption(std::string("Hpm.") + name), nullptr) << name;
  }
}

struct Values {
  std::string name;
  std::vector<std::string> accepted;
  std::vector<std::string> rejected;
  std::string range;  // part of every message about a rejected value
};

const std::vector<Values>& ValueTable() {
  static const std::string kStereo = "PatchMatchStereo.";
  static const std::vector<std::string> kBools = {"0", "1", "true", "No"};
  static const std::vector<std::string> kNoBools = {"2", "", "maybe"};
  static const std::vector<std::string> kNoInts = {
      "3.5", "", "x", "nan", "99999999999"};
  static const auto bools = [](const std::string& name) {
    return Values{name, kBools, kNoBools, "0/1, true/false, yes/no or on/off"};
  };
  static const std::vector<Values> values = {
      {"workspace_path", {"a", "/a b/c"}, {}, ""},
      {"workspace_format",
       {"COLMAP", "pmvs", "Colmap"},
       {"", "PMV", "bundler"},
       "COLMAP, PMVS"},
      {"pmvs_option_name", {"option-0000"}, {}, ""},
      {"config_path", {"x.cfg"}, {}, ""},
      {"project_path", {}, {}, ""},
      {"random_seed", {"0", "-1", "77"}, kNoInts, "int"},
      {"default_random_seed", {"0", "-1", "77"}, kNoInts, "int"},
      bools("log_to_stderr"),
      {"log_target", {"stdout"}, {}, ""},
      {"log_path", {"x"}, {}, ""},
      {"log_level", {"0", "2"}, kNoInts, "int"},
      {"log_severity", {"0", "3"}, kNoInts, "int"},
      bools("log_color"),
      {kStereo + "max_image_size", {"-1", "0", "2000"}, kNoInts, "int"},
      {kStereo + "gpu_index",
       {"-1", "0", "0,0,1"},
       {"x", "", "0,", "-2", "0;1", "0, 1"},
       ">= -1"},
      {kStereo + "window_radius",
       {"1", "5", "32"},
       {"0", "33", "-1", "5.0"},
       "1 to 32"},
      {kStereo + "window_step", {"1", "2"}, {"0", "3"}, "1 to 2"},
      {kStereo + "sigma_spatial",
       {"-1", "0", "2.5"},
       {"nan", "inf", "x"},
       "float"},
      {kStereo + "sigma_color", {"0.2", "1e-3"}, {"0", "-1", "nan"}, "> 0"},
      {kStereo + "num_samples", {"1", "15"}, {"0", "-1", "1.5"}, "> 0"},
      {kStereo + "ncc_sigma", {"0.6"}, {"0", "inf"}, "> 0"},
      {kStereo + "min_triangulation_angle",
       {"0", "179.9"},
       {"-0.1", "180"},
       ">= 0 and < 180"},
      {kStereo + "incident_angle_sigma", {"0.9"}, {"0"}, "> 0"},
      {kStereo + "num_iterations", {"1", "5"}, {"0"}, "> 0"},
      bools(kStereo + "geom_consistency"),
      {kStereo + "geom_consistency_regularizer",
       {"0", "0.3"},
       {"-0.1", "nan"},
       ">= 0"},
      {kStereo + "geom_consistency_max_cost", {"0", "3"}, {"-1"}, ">= 0"},
      bools(kStereo + "filter"),
      {kStereo + "filter_min_ncc",
       {"-1", "1", "0.1"},
       {"-1.1", "1.1"},
       "-1 to 1"},
      {kStereo + "filter_min_triangulation_angle",
       {"0", "180"},
       {"-1", "181"},
       "0 to 180"},
      {kStereo + "filter_min_num_consistent",
       {"0", "5"},
       {"-1", "1.5"},
       ">= 0"},
      {kStereo + "filter_geom_consistency_max_cost",
       {"0", "1e3"},
       {"-1"},
       ">= 0"},
      {kStereo + "cache_size", {"0.5", "32"}, {"0", "-1", "inf"}, "> 0"},
      bools(kStereo + "allow_missing_files"),
      bools(kStereo + "write_consistency_graph"),
      {kStereo + "num_threads",
       {"-1", "0", "64"},
       {"-2", "x", "2147483647"},
       "-1 to 1024"},
      {"Hpm.method",
       {HpmOptions().method, "acmh"},
       {"", "ACMH", "zzz"},
       "hpm_plus, hpm, "},
      {"Hpm.device", {"auto", "cpu", "cuda"}, {"", "gpu", "CPU"}, "auto, cpu"},
      {"Hpm.gpu_images", {"-1", "0", "4"}, {"-2", "1.5", "65"}, "-1 to 64"},
      {"Hpm.cpu_target", {"auto"}, {}, ""},
      {"Hpm.num_iterations",
       {"-1", "3"},
       {"-2", "2.5", "2147483647"},
       "-1 to 10000"},
      {"Hpm.num_geom_iterations", {"-1", "2"}, {"-2"}, "-1 to 10000"},
      {"Hpm.num_geom_passes", {"-1", "2"}, {"-2", "101"}, "-1 to 100"},
      {"Hpm.num_fine_iterations", {"-1", "0", "2"}, {"-2"}, "-1 to 10000"},
      {"Hpm.num_fine_geom_passes", {"-1", "2"}, {"-2", "101"}, "-1 to 100"},
      {"Hpm.geom_weight", {"0", "0.1"}, {"-0.1", "nan"}, ">= 0"},
      {"Hpm.quality",
       {"low", "medium", "high", "extreme"},
       {"High", ""},
       "low, medium, high, extreme"},
      {"Hpm.max_views", {"-1", "32"}, {"-2", "33"}, "-1 to 32"},
      {"Hpm.weak_gradient", {"0", "2.5"}, {"-1"}, ">= 0"},
      {"Hpm.geom_max_error", {"0", "5"}, {"-1"}, ">= 0"},
      {"Hpm.num_levels", {"-1", "8"}, {"-2", "9", "1.5"}, "-1 to 8"},
      {"Hpm.filter_min_agreement", {"0", "1"}, {"-0.1", "1.1"}, "0 to 1"},
      {"Hpm.log_format", {"text", "json"}, {"xml", ""}, "text, json"},
      bools("Hpm.keep_photometric"),
      {"Hpm.depth_ranges", {"ranges.txt"}, {}, ""},
      bools("Hpm.report"),
      {"Hpm.mask_path", {"masks"}, {}, ""},
      bools("Hpm.confidence"),
      bools("Hpm.previews"),
      bools("Hpm.overwrite"),
      {"Hpm.shard",
       {"0/1", "2/3", "99999/100000"},
       {"3/3", "-1/3", "1", "1/", "/3", "1/3x", "0/0", "0/100001", " 0/1"},
       "i/n with 0 <= i < n <= 100000"},
      {"Hpm.stage", {"all", "finish", "level_1_photometric"}, {}, ""},
  };
  return values;
}

// Everything but workspace_path and what the option itself needs is left out.
ParsedOptions ParseOne(const std::string& name, const std::string& value) {
  std::vector<std::string> arguments = {"--" + name, value};
  if (name != "workspace_path")
    arguments.insert(arguments.end(), {"--workspace_path", "w"});
  return ParseOptions(arguments);
}

TEST(OptionTableTest, EveryOptionTakesItsRangeAndRefusesTheRest) {
  for (const Values& values : ValueTable()) {
    const OptionSpec* option = FindOption(values.name);
    ASSERT_NE(option, nullptr) << values.name;
    for (const std::string& value : values.accepted) {
      ParsedOptions parsed = ParseOne(values.name, value);
      EXPECT_TRUE(parsed.problems.empty()) << values.name << " " << value;
      ToolOptions expected;
      ASSERT_TRUE(ParseValue(value, option->member(&expected)));
      EXPECT_EQ(FormatValue(option->member(&parsed.options)),
                FormatValue(option->member(&expected)));
    }
    for (const std::string& value : values.rejected) {
      const ParsedOptions parsed = ParseOne(values.name, value);
      EXPECT_THAT(parsed.problems,
                  Contains(testing::AllOf(HasSubstr("--" + values.name),
                                          HasSubstr("'" + value + "'"),
                                          HasSubstr(values.range))))
          << values.name << " " << value;
    }
  }
}

TEST(OptionTableTest, ValueTableCoversEveryOptionButTheDepthRange) {
  std::set<std::string> names = {"PatchMatchStereo.depth_min",
                                 "PatchMatchStereo.depth_max"};
  for (const Values& values : ValueTable()) names.insert(values.name);
  for (const OptionSpec& option : OptionTable()) {
    EXPECT_EQ(names.count(option.name), 1u) << option.name;
  }
}

TEST(OptionTableTest, DefaultsAreAllowed) {
  for (const OptionSpec& option : OptionTable()) {
    ToolOptions defaults;
    EXPECT_TRUE(option.allowed.contains(option.member(&defaults)))
        << option.name;
  }
}

}  // namespace
}  // namespace hpm
