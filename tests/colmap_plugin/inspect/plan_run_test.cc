#include "colmap_plugin/inspect/plan_run.h"

#include "colmap_plugin/workspace/run_lock.h"
#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

namespace hpm {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class PlanRunTest : public testing::Test {
 protected:
  RunPlan Plan() {
    ControllerOptions options;
    options.workspace.path = scene_.path();
    options.patch_match.num_threads = 1;
    return PlanRun(
        options,
        /*sample_seconds=*/0,
        [](LogLevel, const std::string&) {},
        CancelToken());
  }

  std::set<fs::path> Files() const {
    std::set<fs::path> files;
    for (const auto& entry : fs::recursive_directory_iterator(scene_.path()))
      files.insert(entry.path());
    return files;
  }

  SceneWorkspace scene_{SmallScene(3, 40, 30)};
};

TEST_F(PlanRunTest, ChangesNothingInTheWorkspace) {
  for (const char* folder : {"depth_maps", "normal_maps", "consistency_graphs"})
    fs::remove_all(scene_.path() / "stereo" / folder);
  for (int i = 0; i < 3; ++i) {
    std::vector<unsigned char> bytes;
    cv::Mat deep(30, 40, CV_16U);
    cv::randu(deep, 100, 4000);
    ASSERT_TRUE(cv::imencode(".png", deep, bytes));
    WriteFile(scene_.path() / "images" / ViewName(i),
              {reinterpret_cast<char*>(bytes.data()), bytes.size()});
  }
  const std::set<fs::path> before = Files();
  const RunPlan plan = Plan();
  EXPECT_THAT(plan.problems, ElementsAre());
  EXPECT_EQ(plan.exit_code, 0);
  EXPECT_EQ(Files(), before);
}

TEST_F(PlanRunTest, ARunAtWorkIsTold) {
  CancelToken stop;
  const RunLock lock(scene_.Open().StatePath(), nullptr, &stop);
  const RunPlan plan = Plan();
  EXPECT_EQ(plan.exit_code, static_cast<int>(ErrorCode::kLocked));
  EXPECT_THAT(plan.problems, ElementsAre(HasSubstr("another run")));
}

TEST_F(PlanRunTest, AFileInPlaceOfAFolderIsTold) {
  fs::remove_all(scene_.path() / "stereo/normal_maps");
  WriteFile(scene_.path() / "stereo/normal_maps", "a file");
  const RunPlan plan = Plan();
  EXPECT_EQ(plan.exit_code, static_cast<int>(ErrorCode::kBadInput));
  EXPECT_THAT(plan.problems, ElementsAre(HasSubstr("normal_maps")));
}

TEST(PlanRunTimeTest, IsThatOfPlanningAndOfTheWork) {
  const Sample sample = {10, 1.5, "a.jpg", 160};
  EXPECT_EQ(TimeLine(200, 60, sample),
            "Time: about 80 s, from 1.5 s of a.jpg at 160 pixels; 60.0 s of it "
            "to read and plan");
}

}  // namespace
}  // namespace hpm
