#include "colmap_plugin/tool/parse_options.h"

#include "tests/colmap_plugin/tool/comma_locale.h"

#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

using Words = std::vector<std::string>;

ParsedOptions Parse(Words words) {
  words.insert(words.end(), {"--workspace_path", "w"});
  return ParseOptions(words);
}

std::string WriteProject(const std::string& text) {
  const std::string path =
      testing::TempDir() + "project_" +
      testing::UnitTest::GetInstance()->current_test_info()->name() + ".ini";
  std::ofstream(path) << text;
  return path;
}

TEST(ParseOptionsTest, EqualSignAndNextWordMeanTheSame) {
  const auto spaced = Parse({"--PatchMatchStereo.depth_min",
                             "1",
                             "--PatchMatchStereo.depth_max",
                             "4"});
  const auto joined = Parse(
      {"--PatchMatchStereo.depth_min=1", "--PatchMatchStereo.depth_max=4"});
  for (const ParsedOptions& parsed : {spaced, joined}) {
    EXPECT_THAT(parsed.problems, IsEmpty());
    EXPECT_EQ(parsed.options.controller.problems.depth_min, 1);
    EXPECT_EQ(parsed.options.controller.problems.depth_max, 4);
    EXPECT_EQ(parsed.options.controller.workspace.path, "w");
  }
}

TEST(ParseOptionsTest, NegativeNumberIsAValueAndNotAnOption) {
  const auto parsed =
      Parse({"--PatchMatchStereo.max_image_size", "-1", "--random_seed", "-5"});
  EXPECT_THAT(parsed.problems, IsEmpty());
  EXPECT_EQ(parsed.options.controller.random_seed, -5);
}

TEST(ParseOptionsTest, UniquePrefixIsEnough) {
  const auto parsed =
      ParseOptions({"--workspace_p", "w", "--PatchMatchStereo.max_i=7"});
  EXPECT_THAT(parsed.problems, IsEmpty());
  EXPECT_EQ(parsed.options.controller.workspace.max_image_size, 7);
}

TEST(ParseOptionsTest, FullNameWinsOverLongerNamesWithThatBeginning) {
  const auto parsed = Parse({"--PatchMatchStereo.filter", "off"});
  EXPECT_THAT(parsed.problems, IsEmpty());
  EXPECT_FALSE(parsed.options.controller.patch_match.filter);
}

TEST(ParseOptionsTest, AmbiguousPrefixNamesTheCandidates) {
  const auto parsed = Parse({"--PatchMatchStereo.depth", "1"});
  EXPECT_THAT(parsed.problems,
              ElementsAre(AllOf(HasSubstr("ambiguous"),
                                HasSubstr("depth_min"),
                                HasSubstr("depth_max"))));
}

TEST(ParseOptionsTest, UnknownOptionsAreRefusedWithASuggestion) {
  const auto parsed =
      Parse({"--max_image_size", "7", "--Patchmatchstereo.filter=1", "--zzz"});
  EXPECT_THAT(
      parsed.problems,
      ElementsAre(
          AllOf(HasSubstr("--max_image_size"),
                HasSubstr("did you mean --PatchMatchStereo.max_image_size?")),
          HasSubstr("did you mean --PatchMatchStereo.filter?"),
          "unknown option '--zzz'"));
}

TEST(ParseOptionsTest, SingleDashLongNameIsRefused) {
  EXPECT_THAT(
      Parse({"-config_path", "x"}).problems,
      ElementsAre(
          "unknown option '-config_path'; did you mean --config_path?"));
}

TEST(ParseOptionsTest, OptionGivenTwiceIsRefusedAlsoByPrefix) {
  EXPECT_THAT(Parse({"--config_path", "a", "--conf", "b"}).problems,
              ElementsAre(HasSubstr("--config_path is given twice")));
}

TEST(ParseOptionsTest, BooleanWithoutValueIsRefused) {
  const char* const kName = "--PatchMatchStereo.filter";
  EXPECT_THAT(ParseOptions({"--workspace_path", "w", kName}).problems,
              ElementsAre(HasSubstr(kName)));
  EXPECT_THAT(
      ParseOptions({"--workspace_path=w", std::string(kName) + "="}).problems,
      ElementsAre(HasSubstr(kName)));
  EXPECT_THAT(Parse({kName, "--random_seed=1"}).problems,
              ElementsAre(HasSubstr(kName)));
}

TEST(ParseOptionsTest, StrayWordsAreIgnored) {
  const auto parsed = Parse({"patch_match_stereo", "stray"});
  EXPECT_THAT(parsed.problems, IsEmpty());
}

TEST(ParseOptionsTest, HelpAnywhereComesBeforeAllChecks) {
  EXPECT_TRUE(ParseOptions({"--help"}).help);
  EXPECT_TRUE(ParseOptions({"--workspace_path", "w", "-h"}).help);
  EXPECT_TRUE(
      ParseOptions({"--PatchMatchStereo.window_radius", "99", "--hel", "--zzz"})
          .help);
  EXPECT_FALSE(Parse({}).help);
}

TEST(ParseOptionsTest, MissingWorkspacePathIsSaidAsColmapSaysIt) {
  EXPECT_THAT(
      ParseOptions({}).problems,
      ElementsAre("the option '--workspace_path' is required but missing"));
}

TEST(ParseOptionsTest, AllProblemsAreReportedAtOnceInOneLineEach) {
  const auto parsed = ParseOptions({"--PatchMatchStereo.window_radius=0",
                                    "--PatchMatchStereo.cache_size=nan",
                                    "--PatchMatchStereo.filter=2"});
  EXPECT_THAT(parsed.problems, SizeIs(4));
  EXPECT_EQ(parsed.problems[0],
            "--PatchMatchStereo.window_radius '0' is not allowed; allowed: "
            "int, 1 to 32");
}

TEST(ParseOptionsTest, DepthRangeIsBothAutomaticOrOrderedAndNotNegative) {
  const auto problems = [](const char* depth_min, const char* depth_max) {
    return Parse({"--PatchMatchStereo.depth_min",
                  depth_min,
                  "--PatchMatchStereo.depth_max",
                  depth_max})
        .problems;
  };
  EXPECT_THAT(problems("-1", "-1"), IsEmpty());
  EXPECT_THAT(problems("0", "0"), IsEmpty());
  EXPECT_THAT(problems("0.5", "10"), IsEmpty());
  EXPECT_THAT(problems("-1", "10"), SizeIs(1));
  EXPECT_THAT(problems("1", "-1"), SizeIs(1));
  EXPECT_THAT(problems("-2", "-1"), SizeIs(1));
  EXPECT_THAT(problems("5", "2"),
              ElementsAre(AllOf(HasSubstr("depth_min '5'"),
                                HasSubstr("depth_max '2'"),
                                HasSubstr("0 <= depth_min <= depth_max"))));
}

TEST(ParseOptionsTest, BothSeedNamesSetTheSeedAndMustAgree) {
  EXPECT_EQ(Parse({"--random_seed", "3"}).options.controller.random_seed, 3);
  EXPECT_EQ(
      Parse({"--default_random_seed", "3"}).options.controller.random_seed, 3);
  EXPECT_THAT(
      Parse({"--random_seed", "3", "--default_random_seed", "3"}).problems,
      IsEmpty());
  EXPECT_THAT(
      Parse({"--random_seed", "3", "--default_random_seed", "4"}).problems,
      SizeIs(1));
}

TEST(ParseOptionsTest, GeometricOptionsOfColmapCarryOverOnlyWhenGivenAlone) {
  const HpmOptions defaults;
  EXPECT_EQ(Parse({}).options.controller.hpm.geom_weight, defaults.geom_weight);
  const auto carried = Parse({"--PatchMatchStereo.geom_consistency_regularizer",
                              "0.7",
                              "--PatchMatchStereo.geom_consistency_max_cost",
                              "9"});
  EXPECT_EQ(carried.options.controller.hpm.geom_weight, 0.7);
  EXPECT_EQ(carried.options.controller.hpm.geom_max_error, 9);
  const auto overruled =
      Parse({"--PatchMatchStereo.geom_consistency_regularizer",
             "0.7",
             "--Hpm.geom_weight",
             "0.2"});
  EXPECT_EQ(overruled.options.controller.hpm.geom_weight, 0.2);
  const auto refused =
      Parse({"--PatchMatchStereo.geom_consistency_max_cost", "-9"});
  EXPECT_THAT(refused.problems, SizeIs(1));
}

TEST(ParseOptionsTest, QualitySetsWhatIsNotGiven) {
  const auto hpm = [](const std::vector<std::string>& arguments) {
    return Parse(arguments).options.controller.hpm;
  };
  const HpmOptions defaults;
  const HpmOptions high = hpm({"--Hpm.quality", "high"});
  EXPECT_EQ(high.num_iterations, defaults.num_iterations);
  EXPECT_EQ(high.num_fine_iterations, defaults.num_fine_iterations);
  const HpmOptions low =
      hpm({"--Hpm.quality", "low", "--Hpm.num_geom_passes", "5"});
  EXPECT_EQ(low.num_fine_iterations, 0);
  EXPECT_EQ(low.num_geom_passes, 5);
  // The paper's methods have the paper's effort.
  EXPECT_EQ(
      hpm({"--Hpm.quality", "low", "--Hpm.method", "hpm"}).num_fine_iterations,
      -1);
  EXPECT_THAT(Parse({"--Hpm.quality", "best"}).problems, SizeIs(1));
}

TEST(ParseOptionsTest, OptionsWithoutEffectAreNotedOnlyWhenTheyDiffer) {
  EXPECT_THAT(Parse({"--PatchMatchStereo.sigma_color",
                     "0.2",
                     "--PatchMatchStereo.gpu_index=-1"})
                  .notes,
              IsEmpty());
  EXPECT_THAT(
      Parse({"--PatchMatchStereo.num_iterations", "3"}).notes,
      ElementsAre(AllOf(
          HasSubstr("--PatchMatchStereo.num_iterations has no effect here: "),
          HasSubstr("Hpm.num_iterations"))));
  EXPECT_THAT(Parse({"--PatchMatchStereo.window_radius", "3"}).notes,
              IsEmpty());
}

TEST(ParseOptionsTest, ProjectFileTakesSectionsFlatKeysAndComments) {
  const std::string path = WriteProject(
      "# made by hand\n"
      "workspace_path=/data/dense  # a comment\n"
      "PatchMatchStereo.cache_size = 1.5\r\n"
      "[PatchMatchStereo]\n"
      "max_image_size=1000\n"
      "filter=no\n"
      "[Hpm]\n"
      "num_geom_passes=4\n");
  const auto parsed = ParseOptions({"--project_path", path});
  EXPECT_THAT(parsed.problems, IsEmpty());
  EXPECT_THAT(parsed.notes, IsEmpty());
  const ControllerOptions& options = parsed.options.controller;
  EXPECT_EQ(options.workspace.path, "/data/dense");
  EXPECT_EQ(options.patch_match.cache_size, 1.5);
  EXPECT_EQ(options.workspace.max_image_size, 1000);
  EXPECT_FALSE(options.patch_match.filter);
  EXPECT_EQ(options.hpm.num_geom_passes, 4);
}

TEST(ParseOptionsTest, OnlyTheProjectFileCountsAndThatIsSaid) {
  const std::string path = WriteProject("workspace_path=in_file\n");
  const auto parsed = ParseOptions({"--project_path",
                                    path,
                                    "--workspace_path",
                                    "other",
                                    "--PatchMatchStereo.max_image_size",
                                    "2"});
  EXPECT_THAT(parsed.problems, IsEmpty());
  EXPECT_EQ(parsed.options.controller.workspace.path, "in_file");
  EXPECT_EQ(parsed.options.controller.workspace.max_image_size, -1);
  EXPECT_THAT(parsed.notes, ElementsAre(HasSubstr(path)));
}

TEST(ParseOptionsTest, ProjectFileHasToHoldTheRequiredOptions) {
  const std::string path = WriteProject("random_seed=1\n");
  EXPECT_THAT(
      ParseOptions({"--project_path", path, "--workspace_path", "w"}).problems,
      ElementsAre(HasSubstr("--workspace_path")));
}

TEST(ParseOptionsTest, ProblemsOfAProjectFileNameTheFile) {
  const std::string unknown =
      WriteProject("workspace_path=w\n[ImageReader]\nmask_path=x\n");
  EXPECT_THAT(ParseOptions({"--project_path", unknown}).problems,
              ElementsAre(AllOf(HasSubstr(unknown),
                                HasSubstr("ImageReader.mask_path"))));
  const std::string no_value = WriteProject("workspace_path\n");
  EXPECT_THAT(ParseOptions({"--project_path", no_value}).problems,
              ElementsAre(HasSubstr(no_value)));
  const std::string missing = testing::TempDir() + "no_such.ini";
  EXPECT_THAT(
      ParseOptions({"--project_path", missing}).problems,
      ElementsAre(AllOf(HasSubstr(missing), HasSubstr("No such file"))));
  EXPECT_THAT(ParseOptions({"--project_path", testing::TempDir()}).problems,
              SizeIs(1));
}

TEST(ParseOptionsTest, ProjectFileIsCheckedLikeTheCommandLine) {
  const std::string path = WriteProject(
      "workspace_path=w\nPatchMatchStereo.window_radius=40\n"
      "PatchMatchStereo.filter=1\n[PatchMatchStereo]\nfilter=1\n");
  EXPECT_THAT(
      ParseOptions({"--project_path", path}).problems,
      ElementsAre(HasSubstr("--PatchMatchStereo.window_radius '40'"),
                  HasSubstr("--PatchMatchStereo.filter is given twice")));
}

TEST(ParseOptionsTest, DecimalCommaLocaleChangesNothing) {
  const CommaLocale comma;
  const auto parsed = Parse({"--PatchMatchStereo.cache_size",
                             "1.5",
                             "--PatchMatchStereo.max_image_size=12345"});
  EXPECT_THAT(parsed.problems, IsEmpty());
  EXPECT_EQ(parsed.options.controller.patch_match.cache_size, 1.5);
  EXPECT_EQ(parsed.options.controller.workspace.max_image_size, 12345);
  EXPECT_THAT(Parse({"--PatchMatchStereo.cache_size", "1,5"}).problems,
              SizeIs(1));
  const std::string path =
      WriteProject("workspace_path=w\nPatchMatchStereo.cache_size=2.5\n");
  EXPECT_EQ(ParseOptions({"--project_path", path})
                .options.controller.patch_match.cache_size,
            2.5);
}

TEST(ParseOptionsTest, OddWordsNeverThrow) {
  for (const char* word : {"",
                           "-",
                           "--",
                           "---",
                           "--=",
                           "=",
                           "-h=",
                           "--help=1",
                           "-1",
                           "--\xff",
                           "\n"}) {
    EXPECT_NO_THROW(ParseOptions({word})) << word;
    EXPECT_NO_THROW(ParseOptions({"--workspace_path", word})) << word;
  }
}

}  // namespace
}  // namespace hpm
