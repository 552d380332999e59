#include "src/engine/work_queue.h"

#include <algorithm>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <thread>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;
using testing::UnorderedElementsAreArray;

class WorkQueueTest : public testing::Test {
 protected:
  WorkQueueTest() : items_(50) { std::iota(items_.begin(), items_.end(), 0); }

  void Note(int item) {
    const std::lock_guard<std::mutex> lock(mutex_);
    done_.push_back(item);
  }
  static bool Never(int, const Error&) { return false; }
  static bool Always(int, const Error&) { return true; }

  std::vector<int> items_;
  std::mutex mutex_;
  std::vector<int> done_;
};

TEST_F(WorkQueueTest, EveryItemIsDoneOnce) {
  for (const int num_workers : {1, 2, 7}) {
    done_.clear();
    std::vector<int> workers(num_workers);
    std::iota(workers.begin(), workers.end(), 10);
    const std::vector<int> before = workers;
    const std::vector<int> left = RunWorkQueue(
        items_, &workers, {[&](int, int item) { Note(item); }, Never});
    EXPECT_THAT(left, IsEmpty());
    EXPECT_EQ(workers, before);
    EXPECT_THAT(done_, UnorderedElementsAreArray(items_));
  }
}

TEST_F(WorkQueueTest, OneWorkerGoesInOrderInTheCallersThread) {
  const auto self = std::this_thread::get_id();
  std::vector<int> workers = {3};
  RunWorkQueue(items_,
               &workers,
               {[&](int worker, int item) {
                  EXPECT_EQ(worker, 3);
                  EXPECT_EQ(std::this_thread::get_id(), self);
                  Note(item);
                },
                Never});
  EXPECT_EQ(done_, items_);
}

TEST_F(WorkQueueTest, ItemsOfAWorkerThatGivesUpGoToTheOthers) {
  std::vector<int> workers = {0, 1, 2};
  const std::vector<int> left =
      RunWorkQueue(items_,
                   &workers,
                   {[&](int worker, int item) {
                      if (worker == 1) {
                        throw Error(ErrorCode::kDevice, "broken");
                      }
                      Note(item);
                    },
                    Always});
  EXPECT_THAT(left, IsEmpty());
  EXPECT_THAT(done_, UnorderedElementsAreArray(items_));
  EXPECT_THAT(workers, testing::IsSubsetOf({0, 1, 2}));
  EXPECT_TRUE(std::count(workers.begin(), workers.end(), 0));
  EXPECT_TRUE(std::count(workers.begin(), workers.end(), 2));
}

TEST_F(WorkQueueTest, WhatNoWorkerIsLeftForComesBack) {
  std::vector<int> workers = {0, 1};
  const std::vector<int> left =
      RunWorkQueue(items_,
                   &workers,
                   {[&](int, int item) {
                      if (item >= 20) {
                        throw Error(ErrorCode::kOutOfResources, "full");
                      }
                      Note(item);
                    },
                    Always});
  EXPECT_THAT(workers, IsEmpty());
  EXPECT_EQ(done_.size() + left.size(), items_.size());
  EXPECT_EQ(left.size(), 30u);
}

TEST_F(WorkQueueTest, OtherErrorsEndTheQueueAndAreThrownAgain) {
  for (const int num_workers : {1, 4}) {
    done_.clear();
    std::vector<int> workers(num_workers);
    std::iota(workers.begin(), workers.end(), 0);
    const auto work = [&](int, int item) {
      if (item == 5) throw Error(ErrorCode::kLocked, "five");
      Note(item);
    };
    try {
      RunWorkQueue(items_, &workers, {work, Never});
      FAIL();
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kLocked);
    }
    EXPECT_LT(done_.size(), items_.size());
  }
  std::vector<int> workers = {0, 1};
  const auto work = [](int, int) { throw std::bad_alloc(); };
  EXPECT_THROW(RunWorkQueue(items_, &workers, {work, Always}), std::bad_alloc);
}

TEST_F(WorkQueueTest, NothingToDoIsDone) {
  std::vector<int> workers = {0, 1};
  EXPECT_THAT(RunWorkQueue({}, &workers, {nullptr, nullptr}), IsEmpty());
  EXPECT_THAT(workers, ElementsAre(0, 1));
}

}  // namespace
}  // namespace hpm
