#include "colmap_plugin/workspace/problem.h"

#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <map>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

// Five images in a row; points seen by all of 0 ... 3, as many by 1 and 2.
// Image 4 looks the other way and shares nothing.
class ProblemTest : public ::testing::Test {
 protected:
  ProblemTest() {
    for (int i = 0; i < 4; ++i)
      files_.AddImage(fmt::format("{}.jpg", i), {1.0 * i, 0, 0});
    files_.AddImagePose("4.jpg", "0 0 1 0 4 0 0");
    for (int i = 0; i < 10; ++i) {
      files_.AddPoint({0, 0, 5}, {0, 1, 2, 3});
      files_.AddPoint({1, 0, 5}, {1, 2});
    }
  }

  std::vector<StereoProblem> Read(const std::string& cfg) {
    files_.WriteCfg(cfg);
    return ReadProblems(files_.Open(), options_, files_.Log());
  }

  std::optional<Error> ErrorOfReading(const std::string& cfg) {
    return ErrorOf([&] { Read(cfg); });
  }

  TestWorkspace files_;
  ProblemOptions options_;
};

TEST_F(ProblemTest, FollowTheFile) {
  const auto problems = Read(
      "# comment\r\n 2.jpg\r\n# between\n\n__auto__, 20\r\n"
      "0.jpg\n3.jpg; 1.jpg,,2.jpg, \n"
      "1.jpg\n__auto__ , 1\n"
      "4.jpg\n");
  ASSERT_EQ(problems.size(), 3u);
  EXPECT_EQ(problems[0].ref_image, 2);
  EXPECT_THAT(problems[0].src_images, ElementsAre(1, 0, 3));
  EXPECT_FLOAT_EQ(problems[0].depth_min, 3.75f);
  EXPECT_FLOAT_EQ(problems[0].depth_max, 6.25f);
  EXPECT_EQ(problems[1].ref_image, 0);
  EXPECT_THAT(problems[1].src_images, ElementsAre(3, 1, 2));
  EXPECT_EQ(problems[2].ref_image, 1);
  EXPECT_THAT(problems[2].src_images, ElementsAre(2));
  EXPECT_THAT(files_.Warnings(),
              ElementsAre(testing::AllOf(HasSubstr("patch-match.cfg:10:"),
                                         HasSubstr("'4.jpg'"),
                                         HasSubstr("'__auto__, 20'"))));
}

TEST_F(ProblemTest, FormsThatMeanSomethingElseAreToldWithLineAndRightForm) {
  struct Case {
    const char* cfg;
    std::vector<const char*> words;
  };
  for (const Case& c :
       {Case{"__auto__, 20\n", {":1:", "'__auto__, 20' stands", "two lines"}},
        Case{"0.jpg\n__auto__, 20\n__auto__, 20\n1.jpg\n",
             {":3:", "'__auto__, 20' stands", "two lines"}},
        Case{"0.jpg\n1.jpg\n2.jpg\n", {":3:", "'2.jpg'", "two lines"}},
        Case{"0.jpg\n1.jpg 2.jpg\t3.jpg\n", {":2:", "commas"}},
        Case{"0.jpg\n\n__auto__\n", {":3:", "'__auto__, 20'"}},
        Case{"0.jpg\n__ALL__\n", {":2:", "'__all__'"}},
        Case{"0.jpg\n__auto__, 20\n#5.jpg\n__auto__, 20\n",
             {":3:", "'#5.jpg'", "comments"}}}) {
    SCOPED_TRACE(c.cfg);
    TestWorkspace files;
    for (const char* name : {"0.jpg", "1.jpg", "2.jpg", "3.jpg", "#5.jpg"})
      files.AddImage(name, {0, 0, 0});
    files.AddPoint({0, 0, 5}, {0, 1});
    files.WriteCfg(c.cfg);
    const auto error =
        ErrorOf([&] { ReadProblems(files.Open(), {}, files.Log()); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), HasSubstr("patch-match.cfg"));
    for (const char* word : c.words)
      EXPECT_THAT(error->what(), HasSubstr(word));
  }
}

TEST_F(ProblemTest, WantedSourcesDoNotDependOnPictures) {
  files_.WriteCfg(
      "0.jpg\n__auto__, 2\n1.jpg\n0.jpg, 2.jpg\n2.jpg\n__all__\n"
      "3.jpg\n__auto__, 20\n");
  Workspace workspace = files_.Open();
  const auto before = ReadProblems(workspace, {}, nullptr);
  workspace.DropPicture(1);
  workspace.DropPicture(2);
  const auto after = ReadProblems(workspace, {}, nullptr);
  ASSERT_EQ(before.size(), 4u);
  ASSERT_EQ(after.size(), before.size());
  for (size_t p = 0; p < before.size(); ++p) {
    EXPECT_EQ(before[p].wanted_sources, before[p].src_images);
    EXPECT_EQ(after[p].wanted_sources, before[p].wanted_sources);
    EXPECT_NE(after[p].src_images, before[p].src_images);
  }
}

TEST_F(ProblemTest, APlainListOfNamesIsReadAsColmapDoesWithOneWarning) {
  const auto problems = Read("0.jpg\n1.jpg\n2.jpg\n3.jpg\n");
  EXPECT_EQ(problems.size(), 2u);
  EXPECT_THAT(files_.Warnings(),
              ElementsAre(testing::AllOf(HasSubstr("patch-match.cfg:2:"),
                                         HasSubstr("'1.jpg'"),
                                         HasSubstr("2 lines like it"))));
}

TEST_F(ProblemTest, OneSourceEachIsNoListOfNames) {
  EXPECT_EQ(Read("0.jpg\n1.jpg\n1.jpg\n0.jpg\n").size(), 2u);
  EXPECT_THAT(files_.Warnings(), IsEmpty());
}

TEST_F(ProblemTest, AMissingFileTellsWhatBelongsIntoIt) {
  const auto error = ErrorOf([&] { ReadProblems(files_.Open(), {}, nullptr); });
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("patch-match.cfg is missing"));
}

TEST_F(ProblemTest, ImagesWithoutPictureAreNoSourcesAndFailAsReferences) {
  files_.LeaveOutFile("1.jpg");
  auto problems = Read(
      "2.jpg\n__auto__, 2\n1.jpg\n__auto__, 20\n"
      "3.jpg\n1.jpg,\n0.jpg\n__all__\n");
  const Workspace workspace = files_.Open();
  ASSERT_EQ(problems.size(), 4u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(0, 3));  // still two
  EXPECT_TRUE(CanBeComputed(workspace, problems[0]));
  EXPECT_FALSE(CanBeComputed(workspace, problems[1]));
  EXPECT_THAT(problems[2].src_images, IsEmpty());
  EXPECT_FALSE(CanBeComputed(workspace, problems[2]));
  EXPECT_THAT(problems[3].src_images, ElementsAre(2, 3, 4));
}

TEST_F(ProblemTest, AllTakesEveryOtherImageOverlappingOnesFirst) {
  const auto problems = Read("2.jpg\n__all__\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(1, 0, 3, 4));
}

TEST_F(ProblemTest, NegativeAutoNumberIsUnlimitedAndZeroIsNone) {
  const auto problems = Read("2.jpg\n__auto__, -1\n1.jpg\n__auto__, 0\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(1, 0, 3));
  EXPECT_THAT(
      files_.Warnings(),
      ElementsAre(
          "Ignoring reference image 1.jpg, because it has no source images."));
}

TEST_F(ProblemTest, ReferenceAndRepeatsAreNoSources) {
  const auto problems = Read("0.jpg\n2.jpg, 0.jpg, 1.jpg, 2.jpg\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(2, 1));
}

TEST_F(ProblemTest, ImagesWithoutSourcesAreSkippedWithAWarning) {
  const auto problems =
      Read("4.jpg\n__auto__, 20\n0.jpg\n0.jpg\n1.jpg\n2.jpg, 3.jpg\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].ref_image, 1);
  EXPECT_THAT(files_.Warnings(),
              ElementsAre("Ignoring 2 reference images (the first: 4.jpg), "
                          "because they have no source images."));
}

TEST_F(ProblemTest, NothingToDoIsAnErrorWithARemedy) {
  for (const auto& [cfg, part] : std::map<std::string, std::string>{
           {"", "names no reference image"},
           {"# 0.jpg\n", "image_undistorter"},
           {"0.jpg\n__auto__, 0\n1.jpg\n1.jpg\n", "none of the 2"},
           {"4.jpg\n__auto__, 20\n", "__all__"},
           {"4.jpg\n0.jpg\n", "depth_min"}}) {
    const auto error = ErrorOfReading(cfg);
    ASSERT_TRUE(error) << cfg;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), HasSubstr("patch-match.cfg"));
    EXPECT_THAT(error->what(), HasSubstr(part)) << cfg;
  }
}

TEST_F(ProblemTest, OneSourceIsEnough) {
  const auto problems = Read("0.jpg\n1.jpg\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(1));
}

TEST_F(ProblemTest, ARepeatedReferenceKeepsItsFirstEntry) {
  const auto problems = Read("0.jpg\n1.jpg, 3.jpg\n0.jpg\n__all__\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(1, 3));
  EXPECT_THAT(files_.Warnings(), ElementsAre(HasSubstr("0.jpg")));
}

TEST_F(ProblemTest, UnknownNamesAreErrorsWithFileAndLine) {
  for (const char* cfg : {"0.jpg\n1.jpg\n\nabsent.jpg\n__auto__, 20\n",
                          "0.jpg\n1.jpg\n1.jpg\n0.jpg, absent.jpg\n"}) {
    const auto error = ErrorOfReading(cfg);
    ASSERT_TRUE(error) << cfg;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), HasSubstr("patch-match.cfg"));
    EXPECT_THAT(error->what(), HasSubstr("patch-match.cfg:4:"));
    EXPECT_THAT(error->what(), HasSubstr("absent.jpg"));
  }
}

TEST_F(ProblemTest, AutoWithoutNumberIsAnError) {
  for (const char* cfg : {"0.jpg\n__auto__\n", "0.jpg\n__auto__, x\n"}) {
    const auto error = ErrorOfReading(cfg);
    ASSERT_TRUE(error) << cfg;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  }
}

TEST_F(ProblemTest, ConfigPathReplacesTheWorkspacesFile) {
  options_.config_path = files_.path() / "other.cfg";
  WriteFile(options_.config_path, "3.jpg\n1.jpg\n");
  const auto problems = Read("0.jpg\n1.jpg\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].ref_image, 3);
  options_.config_path = files_.path() / "absent.cfg";
  const auto error = ErrorOfReading("0.jpg\n1.jpg\n");
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr("absent.cfg"));
}

TEST_F(ProblemTest, MinTriangulationAngleIsHonoured) {
  // Seen from 0 and 1 under atan(1/5) = 11.3 degrees, from 0 and 3 under 31.
  options_.min_triangulation_angle = 20;
  const auto problems = Read("0.jpg\n__auto__, 20\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(2, 3));
}

TEST_F(ProblemTest, AnUnknownDepthRangeDoesNotStopTheOthers) {
  EXPECT_EQ(Read("4.jpg\n0.jpg\n0.jpg\n__all__\n").size(), 1u);
  EXPECT_THAT(
      files_.Warnings(),
      ElementsAre(testing::AllOf(HasSubstr("Ignoring reference image 4.jpg"),
                                 HasSubstr("depth_min"),
                                 HasSubstr("depth_max"))));
  options_.depth_min = 1;
  options_.depth_max = 2;
  const auto problems = Read("4.jpg\n0.jpg\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].published.min, 1);
  EXPECT_EQ(problems[0].published.max, 2);
}

TEST_F(ProblemTest, WhatFusionCannotJoinIsSaidOnceBefore) {
  options_.depth_min = 1;
  options_.depth_max = 2;
  Read("4.jpg\n0.jpg\n0.jpg\n__all__\n");
  EXPECT_THAT(files_.Warnings(),
              ElementsAre(testing::AllOf(HasSubstr("reference image 4.jpg"),
                                         HasSubstr("stereo_fusion"),
                                         HasSubstr("point_triangulator"))));
}

TEST_F(ProblemTest, UnusableImagesAreDroppedWithAWarning) {
  files_.AddImagePose("broken.jpg", "1 0 0 0 nan 0 0");
  const auto problems =
      Read("0.jpg\nbroken.jpg, 1.jpg\nbroken.jpg\n0.jpg\n3.jpg\n__all__\n");
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(1));
  EXPECT_THAT(problems[1].src_images, ElementsAre(0, 1, 2, 4));
  EXPECT_THAT(files_.Warnings(),
              ElementsAre(HasSubstr("1 of 6 images not used"),
                          HasSubstr("reference image broken.jpg"),
                          HasSubstr("source image broken.jpg of 0.jpg")));
}

TEST_F(ProblemTest, SourcesBeyondTheLimitAreCutWithOneNote) {
  options_.max_num_src_images = 2;
  const auto problems =
      Read("0.jpg\n4.jpg, 3.jpg, 2.jpg\n2.jpg\n__all__\n1.jpg\n0.jpg, 2.jpg\n");
  ASSERT_EQ(problems.size(), 3u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(4, 3));
  EXPECT_THAT(problems[1].src_images, ElementsAre(1, 0));
  EXPECT_THAT(problems[2].src_images, ElementsAre(0, 2));
  EXPECT_THAT(files_.Notes(), ElementsAre(HasSubstr("2 reference images")));
}

TEST(Problem, AllWithOneImageIsSkipped) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.WriteCfg("a.jpg\n__all__\n");
  EXPECT_TRUE(ErrorOf([&] { ReadProblems(files.Open(), {}, files.Log()); }));
  EXPECT_THAT(files.Warnings(), ElementsAre(HasSubstr("no source images")));
}

}  // namespace
}  // namespace hpm
