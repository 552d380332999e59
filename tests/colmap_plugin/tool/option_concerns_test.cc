// What the table says an option concerns is what it does: fingerprints change
// for exactly those maps, and no byte of a map changes under the same
// fingerprint. A new row is tested without a line here, unless its values are
// of a kind that AnotherValue() does not know.
#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/controller/stage_fingerprint.h"
#include "colmap_plugin/options/method_options.h"
#include "colmap_plugin/options/option_table.h"
#include "colmap_plugin/tool/parse_options.h"
#include "colmap_plugin/workspace/stamp.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <fstream>
#include <iterator>
#include <map>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using Words = std::vector<std::string>;

// A value that is neither the default nor what the default method makes of it,
// and tells on the scene below.
Words AnotherValue(const OptionSpec& option) {
  static const std::map<std::string, Words> special = {
      {"PatchMatchStereo.max_image_size", {"20"}},
      {"PatchMatchStereo.depth_min",
       {"4", "--PatchMatchStereo.depth_max", "7"}},
      {"PatchMatchStereo.depth_max",
       {"7", "--PatchMatchStereo.depth_min", "4"}},
      {"PatchMatchStereo.min_triangulation_angle", {"25"}},
      {"PatchMatchStereo.gpu_index", {"1"}},
      {"PatchMatchStereo.filter_min_ncc", {"0.95"}},
      {"PatchMatchStereo.filter_min_triangulation_angle", {"25"}},
      {"PatchMatchStereo.filter_min_num_consistent", {"1"}},
      {"PatchMatchStereo.filter_geom_consistency_max_cost", {"0.05"}},
      {"Hpm.cpu_target", {"scalar"}},
      {"Hpm.max_views", {"1"}},
      {"Hpm.num_iterations", {"1"}},
      {"Hpm.geom_max_error", {"0.5"}},
      {"Hpm.filter_min_agreement", {"1"}},
      {"pmvs_option_name", {"option-0000"}},
      {"log_target", {"stderr"}},
      {"log_path", {"log"}}};
  const auto found = special.find(option.name);
  if (found != special.end()) return found->second;
  const std::string now = DefaultText(option);
  Words candidates = option.allowed.choices;
  if (candidates.empty() && TypeText(option) != "string")
    candidates = {"3", "0.5", "2", "0", "1"};
  for (const std::string& value : candidates) {
    ToolOptions options;
    const OptionMember member = option.member(&options);
    if (value != now && ParseValue(value, member) &&
        option.allowed.contains(member))
      return {value};
  }
  ADD_FAILURE() << "no other value of " << option.name << " is known here";
  return {now};
}

bool IsGivenByTheTest(const OptionSpec& option) {
  const std::set<std::string> names = {"workspace_path",
                                       "config_path",
                                       "project_path",
                                       "workspace_format",
                                       "Hpm.mask_path",
                                       "Hpm.depth_ranges",
                                       "Hpm.shard",
                                       "Hpm.stage"};
  return names.count(option.name) > 0;
}

ControllerOptions Parse(Words words, const std::string& path) {
  words.insert(words.end(), {"--workspace_path", path});
  if (words[0] != "--Hpm.device")
    words.insert(words.end(), {"--Hpm.device", "cpu"});
  const ParsedOptions parsed = ParseOptions(words);
  EXPECT_THAT(parsed.problems, testing::IsEmpty());
  return parsed.options.controller;
}

// Of the command line.
Words Change(const OptionSpec& option) {
  Words words = {"--" + option.name};
  for (const std::string& word : AnotherValue(option)) words.push_back(word);
  return words;
}

Words WithTwoLevels(Words words) {
  if (words[0] != "--Hpm.num_levels")
    words.insert(words.end(), {"--Hpm.num_levels", "2"});
  return words;
}

struct StageFacts {
  StageSpec spec;
  bool is_final;
  std::string fingerprint;
};

// All stages get one name, so that only options tell them apart.
std::vector<StageFacts> StagesOf(const ControllerOptions& options) {
  std::vector<StageFacts> facts;
  for (const StageSpec& spec :
       MakeSchedule(MakeScheduleOptions(options)).stages) {
    facts.push_back({spec, false, ""});
  }
  facts.back().is_final = true;
  for (StageFacts& stage : facts) {
    stage.fingerprint =
        FingerprintOfStage("stage", stage.spec, stage.is_final, options);
  }
  return facts;
}

TEST(OptionConcerns, ValuesAreInTheFingerprintsOfExactlyTheStagesConcerned) {
  const std::vector<StageFacts> before =
      StagesOf(Parse({"--Hpm.num_levels", "2"}, "w"));
  for (const OptionSpec& option : OptionTable()) {
    if (IsGivenByTheTest(option) || option.concerns == Concerns::kPasses ||
        option.concerns == Concerns::kOtherOptions) {
      continue;
    }
    const std::vector<StageFacts> after =
        StagesOf(Parse(WithTwoLevels(Change(option)), "w"));
    if (option.concerns == Concerns::kAllStages &&
        before.size() != after.size()) {
      continue;  // another method has other stages
    }
    ASSERT_EQ(before.size(), after.size()) << option.name;
    for (size_t s = 0; s < before.size(); ++s) {
      const bool is_geometric = before[s].spec.geometric;
      const bool is_concerned =
          option.concerns == Concerns::kAllStages ||
          (option.concerns == Concerns::kGeometricStages && is_geometric) ||
          (option.concerns == Concerns::kFinalStage && before[s].is_final);
      EXPECT_EQ(before[s].fingerprint != after[s].fingerprint, is_concerned)
          << option.name << ", stage " << s;
    }
  }
}

TEST(OptionConcerns, OptionsThatMakePassesOrSetOptionsChangeSomeStage) {
  const std::vector<StageFacts> before =
      StagesOf(Parse({"--Hpm.num_levels", "2"}, "w"));
  for (const OptionSpec& option : OptionTable()) {
    if (option.concerns != Concerns::kPasses &&
        option.concerns != Concerns::kOtherOptions) {
      continue;
    }
    const std::vector<StageFacts> after =
        StagesOf(Parse(WithTwoLevels(Change(option)), "w"));
    bool has_changed = before.size() != after.size();
    for (size_t s = 0; s < std::min(before.size(), after.size()); ++s)
      has_changed |= before[s].fingerprint != after[s].fingerprint;
    EXPECT_TRUE(has_changed) << option.name;
  }
}

TEST(OptionConcerns, WhatHasNoEffectConcernsNothing) {
  for (const OptionSpec& option : OptionTable()) {
    if (option.no_effect.empty()) continue;
    EXPECT_EQ(option.concerns, Concerns::kNothing) << option.name;
  }
}

// What a run left in a stage: by image, fingerprints and bytes.
constexpr int kNumImages = 4;

struct Result {
  std::map<std::string, std::string> fingerprints, maps;
};

std::string Contents(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string(std::istreambuf_iterator<char>(file), {});
}

using Results = std::map<std::string, Result>;

// By stage.
Results ResultsOf(const SceneWorkspace& scene, const Words& words) {
  const ControllerOptions options = Parse(words, scene.path());
  const CancelToken cancel;
  PatchMatchController(
      options,
      [](LogLevel, const std::string&) {},
      [](const ProgressEvent&) {},
      cancel)
      .Run();
  Results results;
  for (int image = 0; image < kNumImages; ++image) {
    const std::string name = ViewName(image);
    for (const std::string stage : {"photometric", "geometric"}) {
      const std::filesystem::path stereo = scene.path() / "stereo";
      const std::string file = name + "." + stage + ".bin";
      const auto stamp = ReadStamp(stereo / "hpm_mvs", name, stage);
      results[stage].fingerprints[name] = stamp ? stamp->fingerprint : "";
      results[stage].maps[name] = Contents(stereo / "depth_maps" / file) +
                                  Contents(stereo / "normal_maps" / file);
    }
  }
  return results;
}

// The whole program with each option, on a scene so small that it takes no
// time: maps of the same fingerprint are the same; and there is no other
// fingerprint where all maps stay.
TEST(OptionConcerns, FingerprintsChangeWhereMapsDo) {
  const TestScene scene = MakeLowTextureWall(SmallScene(kNumImages, 24, 18));
  for (const std::string levels : {"1", "2"}) {
    const Words common = {"--Hpm.num_levels", levels};
    const auto run = [&](Words words) {
      if (words[0] != common[0])
        words.insert(words.end(), common.begin(), common.end());
      return ResultsOf(SceneWorkspace(scene), words);
    };
    const Results before = run({"--Hpm.method", kDefaultMethod});
    for (const OptionSpec& option : OptionTable()) {
      if (IsGivenByTheTest(option)) continue;
      SCOPED_TRACE(option.name + ", levels " + levels);
      const Results after = run(Change(option));
      for (const auto& [stage, was] : before) {
        // Which it leaves out.
        if (option.name == "Hpm.keep_photometric" && stage == "photometric")
          continue;
        const Result& is = after.at(stage);
        for (const auto& [image, maps] : was.maps) {
          ASSERT_FALSE(maps.empty() || was.fingerprints.at(image).empty());
          if (option.concerns == Concerns::kRounding ||
              is.fingerprints.at(image) != was.fingerprints.at(image)) {
            continue;
          }
          EXPECT_TRUE(is.maps.at(image) == maps) << stage << " " << image;
        }
        // Of a sky; the scene has none.
        if (option.name == "Hpm.filter_min_agreement") continue;
        EXPECT_TRUE(is.maps != was.maps || is.fingerprints == was.fingerprints)
            << stage << ": no map changed, but the fingerprints did";
      }
    }
  }
}

}  // namespace
}  // namespace hpm
