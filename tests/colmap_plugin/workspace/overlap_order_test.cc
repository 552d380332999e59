#include "colmap_plugin/workspace/overlap_order.h"

#include <algorithm>
#include <ctime>
#include <numeric>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::ElementsAre;

StereoProblem ProblemOf(int image, const std::vector<int>& sources) {
  StereoProblem problem;
  problem.ref_image = image;
  problem.wanted_sources = sources;
  return problem;
}

// In a row of images, each with its neighbours as sources.
StereoProblem InARow(int image) {
  return ProblemOf(image, {image + 1, std::max(image - 1, 0)});
}

std::vector<StereoProblem> Row(const std::vector<int>& images) {
  std::vector<StereoProblem> problems;
  std::transform(
      images.begin(), images.end(), std::back_inserter(problems), InARow);
  return problems;
}

std::vector<int> Order(std::vector<StereoProblem> problems, size_t begin = 0) {
  OrderByOverlap(&problems, begin);
  std::vector<int> images;
  for (const StereoProblem& problem : problems)
    images.push_back(problem.ref_image);
  return images;
}

TEST(OverlapOrder, FollowsARowFromTheFirst) {
  EXPECT_THAT(Order(Row({1, 4, 6, 2, 5, 3})), ElementsAre(1, 2, 3, 4, 5, 6));
}

TEST(OverlapOrder, KeepsTheOrderOfEquals) {
  EXPECT_THAT(
      Order({ProblemOf(2, {1, 3}), ProblemOf(3, {1, 2}), ProblemOf(1, {2, 3})}),
      ElementsAre(2, 3, 1));
  EXPECT_THAT(Order({ProblemOf(9, {8}), ProblemOf(1, {2}), ProblemOf(5, {4})}),
              ElementsAre(9, 1, 5));
}

TEST(OverlapOrder, AmongEqualsTheOneThatSharesMoreWithTheLastFewIsNext) {
  // 7 and 8 share one image with 2; 8 shares another with 1, before it.
  EXPECT_THAT(Order({ProblemOf(1, {20, 21, 22}),
                     ProblemOf(2, {20, 21, 23}),
                     ProblemOf(7, {23, 31}),
                     ProblemOf(8, {23, 22})}),
              ElementsAre(1, 2, 8, 7));
}

TEST(OverlapOrder, GoesBackToWhatItPassedBeforeItLeaves) {
  EXPECT_THAT(Order(Row({5, 100, 6, 7, 4, 3, 101})),
              ElementsAre(5, 6, 7, 4, 3, 100, 101));
}

TEST(OverlapOrder, WhatIsBeforeTheBeginningStaysAndIsGoneOnFrom) {
  EXPECT_THAT(Order(Row({1, 100, 50, 102, 2, 101}), 2),
              ElementsAre(1, 100, 101, 102, 2, 50));
}

TEST(OverlapOrder, DoesNotDependOnPictures) {
  std::vector<StereoProblem> problems = Row({1, 4, 2, 3});
  problems[1].src_images = problems[0].wanted_sources;
  EXPECT_THAT(Order(problems), ElementsAre(1, 2, 3, 4));
}

TEST(OverlapOrder, NeighboursInASurveyFollowEachOther) {
  constexpr int kSide = 30;
  std::vector<StereoProblem> problems;
  for (int i = 0; i < kSide * kSide; ++i) {
    StereoProblem problem = ProblemOf(i, {});
    const int x = i % kSide, y = i / kSide;
    if (x > 0) problem.wanted_sources.push_back(i - 1);
    if (x + 1 < kSide) problem.wanted_sources.push_back(i + 1);
    if (y > 0) problem.wanted_sources.push_back(i - kSide);
    if (y + 1 < kSide) problem.wanted_sources.push_back(i + kSide);
    problems.push_back(problem);
  }
  std::shuffle(problems.begin(), problems.end(), std::mt19937(1));
  OrderByOverlap(&problems);
  int num_new = 0;
  std::set<int> before, seen;
  for (const StereoProblem& problem : problems) {
    std::set<int> images(problem.wanted_sources.begin(),
                         problem.wanted_sources.end());
    images.insert(problem.ref_image);
    num_new += static_cast<int>(
        std::count_if(images.begin(), images.end(), [&](int image) {
          return before.count(image) == 0;
        }));
    before = images;
    seen.insert(problem.ref_image);
  }
  EXPECT_EQ(seen.size(), problems.size());
  // Two of five are shared in a row; as they were given, next to none.
  EXPECT_LE(num_new, 3.3 * kSide * kSide);
}

TEST(OverlapOrder, ImagesThatAllShareDoNotMakeItSlow) {
  constexpr int kNumProblems = 20000;
  std::vector<int> hubs(32);
  std::iota(hubs.begin(), hubs.end(), kNumProblems);
  std::vector<StereoProblem> problems;
  for (int i = 0; i < kNumProblems; ++i) problems.push_back(ProblemOf(i, hubs));
  const std::clock_t start = std::clock();
  OrderByOverlap(&problems);
  // A fraction of a second; with every problem compared to every other,
  // half a minute.
  EXPECT_LT(std::clock() - start, 6 * CLOCKS_PER_SEC);
  EXPECT_EQ(problems.back().ref_image, kNumProblems - 1);
}

}  // namespace
}  // namespace hpm
