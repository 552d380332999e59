// What a run does when GPUs fail.
#include "src/engine/worker_pool.h"

#include "src/engine/gpu_error.h"
#include "tests/engine/still_backend.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

class WorkerPoolTest : public testing::Test {
 protected:
  WorkerPool MakePool(int num_gpus, bool may_fall_back) {
    const auto make = [&](int count) {
      std::vector<std::unique_ptr<Backend>> backends;
      for (int i = 0; i < count; ++i)
        backends.push_back(std::make_unique<StillBackend>(&log_));
      return backends;
    };
    return WorkerPool(
        make(1),
        make(num_gpus),
        may_fall_back,
        [this](LogLevel, const std::string& line) { lines_.push_back(line); });
  }
  StillLog log_;
  std::vector<std::string> lines_;
};

TEST_F(WorkerPoolTest, WhenAllGpusGiveUpTheCpuGoesOn) {
  WorkerPool pool = MakePool(2, true);
  std::mutex mutex;
  int num_refused = 0;
  std::vector<int> done;
  const auto compute = [&](Worker*, int problem) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (problem == 3 && num_refused < 2) {
      ++num_refused;
      throw GpuError(ErrorCode::kOutOfResources, "out of memory");
    }
    done.push_back(problem);
  };
  pool.Run({0, 1, 2, 3, 4, 5}, compute);
  EXPECT_THAT(done, testing::UnorderedElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(lines_,
              ElementsAre(HasSubstr("fewer images"), HasSubstr("the CPU")));
  pool.Run({6, 7}, compute);  // the next stage
  EXPECT_EQ(done.size(), 8u);
}

TEST_F(WorkerPoolTest, WithoutFallBackTheLastGpuThrows) {
  WorkerPool pool = MakePool(2, false);
  const auto compute = [](Worker*, int) {
    throw GpuError(ErrorCode::kDevice, "broken");
  };
  EXPECT_THROW(pool.Run({0, 1, 2}, compute), GpuError);
}

TEST_F(WorkerPoolTest, AFullDiskIsNoReasonToGiveAGpuUp) {
  WorkerPool pool = MakePool(2, true);
  const auto compute = [](Worker*, int) {
    throw Error(ErrorCode::kOutOfResources, "disk full");
  };
  EXPECT_THROW(pool.Run({0, 1, 2}, compute), Error);
  EXPECT_TRUE(lines_.empty());
}

}  // namespace
}  // namespace hpm
