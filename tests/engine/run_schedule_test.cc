// Which stage runs when, on what, with whose maps.
#include "src/engine/run_schedule.h"

#include "src/engine/memory_stores.h"
#include "src/engine/work_estimate.h"
#include "tests/engine/still_backend.h"

#include <functional>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr int kWidth = 24, kHeight = 16;
constexpr int kNumImages = 3;

// Writes down what is written, and fails where it is told to.
class WatchedStore : public MemoryMapStore {
 public:
  using MemoryMapStore::MemoryMapStore;

  bool IsNeeded(int stage, int problem) const override {
    return left_out.count({stage, problem}) == 0;
  }
  void Write(int stage, int problem, StageOutput* output) override {
    if (bad.count({stage, problem}) > 0)
      throw Error(ErrorCode::kBadInput, "made up");
    {
      const std::lock_guard<std::mutex> lock(mutex);
      written.emplace(stage, problem);
      if (!output->is_complete) incomplete.emplace(stage, problem);
    }
    MemoryMapStore::Write(stage, problem, output);
  }

  using Places = std::set<std::pair<int, int>>;  // of stage and problem
  Places left_out, bad, written, incomplete;
  std::mutex mutex;
};

class RunScheduleTest : public testing::Test {
 protected:
  RunScheduleTest() {
    ScheduleOptions options;
    options.method = "acmm";
    options.num_levels = 2;
    options.num_geom_passes = 1;
    spec_.schedule = MakeSchedule(options);
    for (int i = 0; i < kNumImages; ++i) {
      Problem problem;
      problem.image = i;
      problem.camera = CameraOf(i);
      problem.depth_min = 2;
      problem.depth_max = 8;
      for (int j = 0; j < kNumImages; ++j) {
        if (j != i) problem.sources.push_back({j, CameraOf(j), 0});
      }
      spec_.problems.push_back(problem);
    }
    store_ = std::make_unique<WatchedStore>(spec_.problems);
  }

  static Camera CameraOf(int image) {
    return {kWidth,
            kHeight,
            20,
            20,
            0.5f * (kWidth - 1),
            0.5f * (kHeight - 1),
            {{1, 0, 0, 0, 1, 0, 0, 0, 1}},
            {-0.5f * static_cast<float>(image), 0, 0}};
  }

  static std::vector<GrayImage> Grey() {
    return std::vector<GrayImage>(
        kNumImages,
        {kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 7)});
  }

  void Run(const RunEvents& events = {}) {
    MemoryImageStore images(Grey());
    RunOn(&images, events);
  }
  void RunOn(ImageStore* images, const RunEvents& events) {
    std::vector<std::unique_ptr<Backend>> cpus;
    for (int i = 0; i < 2; ++i)
      cpus.push_back(std::make_unique<StillBackend>(&log_));
    WorkerPool workers(
        std::move(cpus), {}, false, [](LogLevel, const std::string&) {});
    RunSchedule(spec_, images, store_.get(), &workers, events);
  }

  int num_stages() const {
    return static_cast<int>(spec_.schedule.stages.size());
  }

  RunSpec spec_;
  std::unique_ptr<WatchedStore> store_;
  StillLog log_;
};

TEST_F(RunScheduleTest, EveryStageOfAProblemSeesItsLevelAndTheMapsBefore) {
  Run();
  ASSERT_EQ(num_stages(), 4);
  ASSERT_EQ(log_.views.size(), 4u * kNumImages);
  for (size_t i = 0; i < log_.views.size(); ++i) {
    const size_t stage = i / kNumImages;  // no problem before all of a stage
    const int factor = stage < 2 ? 2 : 1;
    const ViewSet& views = log_.views[i];
    EXPECT_EQ(views.ref.camera.width, kWidth / factor) << i;
    EXPECT_EQ(views.ref.image->width, kWidth / factor) << i;
    ASSERT_EQ(views.srcs.size(), 2u);
    for (const View& src : views.srcs) {
      EXPECT_EQ(src.camera.width, kWidth / factor) << i;
      EXPECT_EQ(src.image->height, kHeight / factor) << i;
      ASSERT_EQ(src.inverse_depth != nullptr, stage % 2 == 1) << i;
      if (src.inverse_depth == nullptr) continue;
      const InverseDepths depths = src.inverse_depth->View();
      EXPECT_NEAR(depths.step * InverseDepthSteps(depths.steps, 0),
                  1 / kStillDepth,
                  1e-4)
          << i;
    }
  }
  EXPECT_TRUE(store_->incomplete.empty());
  for (int p = 0; p < kNumImages; ++p) {
    ASSERT_NE(store_->map(p), nullptr);
    EXPECT_EQ(store_->map(p)->planes.size(), size_t{kWidth} * kHeight);
  }
}

TEST_F(RunScheduleTest, ASourceOfFinerDetailIsHalved) {
  spec_.problems[0].sources[0].more_levels = 1;
  Run();
  int num_halved = 0;
  for (const ViewSet& views : log_.views) {
    const View& src = views.srcs[0];
    if (src.camera.width * 2 != views.ref.camera.width) continue;
    ++num_halved;
    EXPECT_EQ(src.image->width, src.camera.width);
    if (src.inverse_depth == nullptr) continue;
    EXPECT_EQ(
        src.inverse_depth->steps.size(),
        size_t{kInverseDepthBytes} * src.camera.width * src.camera.height + 1);
  }
  EXPECT_EQ(num_halved, num_stages());
}

// The last resort of a user with one bad file among thousands.
TEST_F(RunScheduleTest, AProblemThatFailsIsLeftOutAndMissedByTheOthers) {
  store_->bad = {{0, 1}};
  std::vector<std::pair<int, int>> failures;
  RunEvents events;
  events.failed = [&](int stage, int problem, const Error&) {
    failures.emplace_back(stage, problem);
  };
  Run(events);
  EXPECT_THAT(failures, ElementsAre(std::pair(0, 1)));
  EXPECT_EQ(store_->map(1), nullptr);
  EXPECT_NE(store_->map(0), nullptr);
  // From the first stage on that reads its maps.
  for (int stage = 0; stage < num_stages(); ++stage) {
    EXPECT_EQ(store_->written.count({stage, 1}), 0u);
    EXPECT_EQ(store_->incomplete.count({stage, 0}), stage == 0 ? 0u : 1u);
  }
}

TEST_F(RunScheduleTest, WithoutAHandlerAFailureEndsTheRun) {
  store_->bad = {{1, 2}};
  EXPECT_THROW(Run(), Error);
  EXPECT_EQ(store_->written.count({2, 0}), 0u);
}

TEST_F(RunScheduleTest, WhatTheStoreDoesNotNeedIsNotComputed) {
  for (int stage = 0; stage < num_stages(); ++stage) {
    for (int p = 0; p < kNumImages; ++p) {
      if (stage != 0 || p == 1) store_->left_out.emplace(stage, p);
    }
  }
  double last = 0;
  RunEvents events;
  events.progress = [&](const RunProgress& at) { last = at.fraction; };
  Run(events);
  EXPECT_THAT(store_->written, ElementsAre(std::pair(0, 0), std::pair(0, 2)));
  EXPECT_EQ(last, 1);
}

TEST_F(RunScheduleTest, ProgressRisesToOneAndNamesThePlace) {
  std::vector<RunProgress> all;
  int num_started = 0;
  RunEvents events;
  events.started = [&](const RunProgress& at) {
    ++num_started;
    EXPECT_GE(at.problem, 0);
  };
  events.progress = [&](const RunProgress& at) { all.push_back(at); };
  Run(events);
  EXPECT_EQ(num_started, num_stages() * kNumImages);
  double before = 0;
  int num_stage_ends = 0;
  for (const RunProgress& at : all) {
    EXPECT_GE(at.fraction, before);
    EXPECT_EQ(at.num_problems, kNumImages);
    before = at.fraction;
    num_stage_ends += at.problem < 0;
  }
  EXPECT_EQ(num_stage_ends, num_stages());
  EXPECT_EQ(before, 1);
}

// The backend tells of the middle of each pass.
TEST_F(RunScheduleTest, ProgressIsMeasuredInEstimatedWork) {
  spec_.filter = MapFilter{{0.1f, 0.01f, 1, 2}};
  double total = kFilterWork;
  std::vector<double> middles;
  for (int stage = 0; stage < num_stages(); ++stage) {
    for (int p = 1; p < kNumImages; ++p) store_->left_out.emplace(stage, p);
    const StageSpec& spec = spec_.schedule.stages[stage];
    const double pixels = 1.0 / (1 << (2 * spec.level));
    double work = JudgeWork(spec);
    for (const Pass& pass : spec.passes) {
      middles.push_back(total - kFilterWork +
                        pixels * (work + 0.5 * PassWork(pass)));
      work += PassWork(pass);
    }
    total += pixels * StageWork(spec);
  }
  std::vector<double> told;
  RunEvents events;
  events.progress = [&](const RunProgress& at) {
    if (at.problem >= 0) told.push_back(at.fraction);
  };
  Run(events);
  ASSERT_EQ(told.size(), middles.size());
  for (size_t i = 0; i < told.size(); ++i)
    EXPECT_NEAR(told[i], middles[i] / total, 1e-9) << i;
}

// As COLMAP does for images with few sources.
TEST_F(RunScheduleTest, TheFilterAsksForNoMoreViewsThanThereAre) {
  spec_.filter = MapFilter{{0.1f, 0.01f, 1, 4}};
  spec_.problems[2].sources.pop_back();
  Run();
  ASSERT_EQ(log_.filters.size(), size_t{kNumImages});  // the last stage alone
  std::multiset<int> asked;
  for (const FilterParams& filter : log_.filters)
    asked.insert(filter.min_num_consistent);
  EXPECT_THAT(asked, ElementsAre(1, 2, 2));
}

// A problem's images must not be in memory beside those of the next.
TEST_F(RunScheduleTest, TheBackendForgetsTheViewsWhenAStageIsDone) {
  spec_.filter = MapFilter{{0.1f, 0.01f, 1, 1}};
  spec_.schedule.stages.resize(1);
  spec_.problems.resize(1);
  Run();
  EXPECT_THAT(log_.calls, ElementsAre("set", "run", "filter", "forget"));
}

TEST_F(RunScheduleTest, ACancelledRunEnds) {
  CancelToken cancel;
  RunEvents events;
  events.cancel = &cancel;
  events.progress = [&](const RunProgress& at) {
    if (at.stage == 1) cancel.Cancel();
  };
  try {
    Run(events);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kInterrupted);
  }
  EXPECT_EQ(store_->written.count({2, 0}), 0u);
}

// Runs what is no use, and returns the error.
std::string UsageErrorOf(const std::function<void()>& run) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::kUsage);
    return error.what();
  }
  return "no error";
}

TEST_F(RunScheduleTest, WhatCannotBeRunIsRefusedBeforeAnythingIsDone) {
  const RunSpec good = spec_;
  spec_.problems[1].sources.resize(kMaxViews + 1);
  EXPECT_THAT(UsageErrorOf([&] { Run(); }), HasSubstr("33 sources"));
  EXPECT_THAT(log_.calls, testing::IsEmpty());
  spec_ = good;
  spec_.filter = MapFilter();
  spec_.schedule.stages.back().passes.clear();
  EXPECT_THAT(UsageErrorOf([&] { Run(); }), HasSubstr("no passes"));
  EXPECT_THAT(log_.calls, testing::IsEmpty());
}

TEST_F(RunScheduleTest, PicturesThatAreNotTheCamerasEndTheRun) {
  const RunSpec good = spec_;
  spec_.problems[0].camera.width *= 2;
  EXPECT_THAT(UsageErrorOf([&] { Run(); }), HasSubstr("its camera 24 x 8"));
  spec_ = good;
  spec_.problems[0].sources[1].camera.height /= 2;
  EXPECT_THAT(UsageErrorOf([&] { Run(); }),
              HasSubstr("image 2: the picture has 12 x 8 pixels"));
  for (const int image : {-1, kNumImages}) {
    spec_ = good;
    spec_.problems[0].sources[0].image = image;
    EXPECT_THAT(UsageErrorOf([&] { Run(); }), HasSubstr("there is no picture"));
  }
}

class BrokenImages : public MemoryImageStore {
 public:
  using MemoryImageStore::MemoryImageStore;
  std::vector<std::shared_ptr<const GrayImage>> Images(
      const std::vector<ImageRequest>& requests) override {
    for (const ImageRequest& request : requests) {
      if (request.image != 2) throw UnreadableImages({{request.image, "torn"}});
    }
    return MemoryImageStore::Images(requests);
  }
};

// They would change what the others are matched against, so they are no failure
// of one problem. All are told at once, so that one new plan does.
TEST_F(RunScheduleTest, ImagesThatCannotBeReadEndTheRunAfterTheStage) {
  spec_.problems[2].sources.clear();
  RunEvents events;
  events.failed = [](int, int, const Error&) { ADD_FAILURE(); };
  BrokenImages images(Grey());
  try {
    RunOn(&images, events);
    ADD_FAILURE();
  } catch (const UnreadableImages& error) {
    EXPECT_THAT(
        error.reasons(),
        ElementsAre(testing::Pair(0, "torn"), testing::Pair(1, "torn")));
  }
  EXPECT_THAT(store_->written, ElementsAre(std::pair(0, 2)));
}

}  // namespace
}  // namespace hpm
