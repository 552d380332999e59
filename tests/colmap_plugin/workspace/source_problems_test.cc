#include "colmap_plugin/workspace/source_problems.h"

#include "colmap_plugin/workspace/model_overview.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// Five images in a row; neighbours and their neighbours share points, image 4
// has none.
class SourceProblemsTest : public testing::Test {
 protected:
  SourceProblemsTest() {
    for (int i = 0; i < 5; ++i)
      files_.AddImage(fmt::format("{}.jpg", i), {0.5 * i, 0, 0});
    for (int i = 0; i < 2 * static_cast<int>(kEnoughPoints); ++i)
      files_.AddPoint({0.5 * (i % 2), 0, 4}, {i % 2, i % 2 + 1, i % 2 + 2});
  }

  std::vector<StereoProblem> SourcesOf(const std::string& cfg,
                                       const ProblemOptions& options = {}) {
    files_.WriteCfg(cfg);
    const Workspace workspace = files_.Open();
    const CancelToken never;
    const ModelOverview overview(workspace, options, never);
    return SourceProblems(workspace,
                          overview,
                          ReadProblems(workspace, options, nullptr),
                          options,
                          nullptr,
                          never);
  }

  TestWorkspace files_;
};

TEST_F(SourceProblemsTest, AreAddedForSourcesThatAreNoReferences) {
  const auto problems = SourcesOf("0.jpg\n__auto__, 2\n");
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0].ref_image, 1);
  EXPECT_EQ(problems[1].ref_image, 2);
  for (const StereoProblem& problem : problems) {
    EXPECT_FALSE(problem.is_reference);
    EXPECT_FLOAT_EQ(problem.depth_min, 3);
    EXPECT_FLOAT_EQ(problem.depth_max, 5);
  }
  // As "__auto__, 20" would choose: 4 shares no points, but sees the same.
  EXPECT_THAT(problems[0].src_images, ElementsAre(2, 0, 3, 4));
}

TEST_F(SourceProblemsTest, AreNoneWhereAllSourcesAreReferences) {
  EXPECT_THAT(SourcesOf("0.jpg\n1.jpg\n1.jpg\n0.jpg\n"), IsEmpty());
}

TEST_F(SourceProblemsTest, WithoutPointsThoseThatSeeTheSameHelp) {
  const auto problems = SourcesOf("0.jpg\n4.jpg\n1.jpg\n4.jpg, 0.jpg\n");
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].ref_image, 4);
  EXPECT_THAT(problems[0].src_images, ElementsAre(0, 1, 2, 3));
  EXPECT_FLOAT_EQ(problems[0].depth_min, 3);
  EXPECT_FLOAT_EQ(problems[0].depth_max, 5);
}

TEST_F(SourceProblemsTest, TakeNoMoreSourcesThanAllowed) {
  ProblemOptions options;
  options.max_num_src_images = 1;
  const auto problems = SourcesOf("0.jpg\n__auto__, 20\n", options);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_THAT(problems[0].src_images, ElementsAre(2));
}

TEST_F(SourceProblemsTest, ImagesWithoutPictureHaveNoneAndAreNoSources) {
  files_.LeaveOutFile("2.jpg");
  const auto problems = SourcesOf("0.jpg\n__auto__, 1\n2.jpg\n3.jpg, 4.jpg\n");
  // Nor has the reference without picture brought its own along.
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].ref_image, 1);
  EXPECT_THAT(problems[0].src_images, ElementsAre(0, 3, 4));
}

TEST_F(SourceProblemsTest, TheNumberOfSourcesIsMetWithPictures) {
  files_.LeaveOutFile("2.jpg");
  ProblemOptions options;
  options.max_num_src_images = 1;
  const auto problems = SourcesOf("0.jpg\n__auto__, 20\n", options);
  ASSERT_EQ(problems.size(), 1u);
  EXPECT_EQ(problems[0].ref_image, 1);
  EXPECT_THAT(problems[0].src_images, ElementsAre(0));
}

}  // namespace
}  // namespace hpm
