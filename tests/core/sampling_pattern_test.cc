#include "src/core/sampling_pattern.h"

#include <algorithm>
#include <cstdlib>
#include <set>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using Offset = std::pair<int, int>;  // col, row

// The first `count` samples of a region.
std::vector<Offset> Samples(const SamplingPattern& pattern,
                            int region,
                            int count) {
  std::vector<Offset> samples;
  for (int k = 0; k < count; ++k) {
    samples.push_back({pattern.dcol[region][k], pattern.drow[region][k]});
  }
  return samples;
}

int CountAtMost(const SamplingPattern& pattern, int region) {
  return pattern.num_base[region] << pattern.max_extensions;
}

std::vector<std::vector<Offset>> Regions(const SamplingPattern& pattern,
                                         int doublings) {
  std::vector<std::vector<Offset>> regions;
  for (int i = 0; i < kNumRegions; ++i) {
    regions.push_back(Samples(pattern, i, pattern.num_base[i] << doublings));
  }
  return regions;
}

class EveryPattern : public testing::TestWithParam<bool> {};
INSTANTIATE_TEST_SUITE_P(LocalAndNonLocal, EveryPattern, testing::Bool());

TEST_P(EveryPattern, ReachesOnlyTheOtherColour) {
  const SamplingPattern pattern = MakeSamplingPattern(GetParam(), true);
  for (int i = 0; i < kNumRegions; ++i) {
    for (const auto& [col, row] :
         Samples(pattern, i, CountAtMost(pattern, i))) {
      EXPECT_EQ((std::abs(col) + std::abs(row)) % 2, 1)
          << i << ": " << col << ", " << row;
    }
  }
  EXPECT_EQ(pattern.mask_distance % 2, 1);
}

TEST_P(EveryPattern, NoPixelIsSampledTwice) {
  const SamplingPattern pattern = MakeSamplingPattern(GetParam(), true);
  for (int i = 0; i < kNumRegions; ++i) {
    const auto samples = Samples(pattern, i, CountAtMost(pattern, i));
    EXPECT_EQ(std::set<Offset>(samples.begin(), samples.end()).size(),
              samples.size());
  }
  std::set<Offset> base;
  size_t count = 0;
  for (const auto& region : Regions(pattern, 0)) {
    base.insert(region.begin(), region.end());
    count += region.size();
  }
  EXPECT_EQ(base.size(), count);
}

// Turning the picture by 90 degrees turns the set of regions into itself.
TEST_P(EveryPattern, HasQuarterTurnSymmetry) {
  const SamplingPattern pattern = MakeSamplingPattern(GetParam(), true);
  auto regions = Regions(pattern, pattern.max_extensions);
  auto turned = regions;
  for (auto& region : turned) {
    for (Offset& offset : region) offset = {-offset.second, offset.first};
  }
  std::sort(regions.begin(), regions.end());
  std::sort(turned.begin(), turned.end());
  EXPECT_EQ(regions, turned);
}

TEST_P(EveryPattern, ExtensionsAreOptionalAndDoNotChangeTheBase) {
  const SamplingPattern fixed = MakeSamplingPattern(GetParam(), false);
  const SamplingPattern growing = MakeSamplingPattern(GetParam(), true);
  EXPECT_EQ(fixed.max_extensions, 0);
  EXPECT_EQ(growing.max_extensions, 3);
  EXPECT_EQ(Regions(fixed, 0), Regions(growing, 0));
}

TEST_P(EveryPattern, RegionsGrowOutwards) {
  const SamplingPattern pattern = MakeSamplingPattern(GetParam(), true);
  for (int i = 0; i < kNumRegions; ++i) {
    const auto samples = Samples(pattern, i, CountAtMost(pattern, i));
    for (size_t k = 1; k < samples.size(); ++k) {
      const auto distance = [&](size_t at) {
        return std::abs(samples[at].first) + std::abs(samples[at].second);
      };
      EXPECT_GE(distance(k), distance(k - 1));
    }
  }
}

// The paper gives the counts and R = 4, its authors' code the offsets.
TEST(Nesp, BaseOffsetsAreAPinwheelBeyondTheRadius) {
  const std::vector<std::vector<Offset>> expected = {
      {{0, -5}, {0, -7}, {0, -9}, {0, -11}, {0, -13}},
      {{0, 5}, {0, 7}, {0, 9}, {0, 11}, {0, 13}},
      {{-5, 0}, {-7, 0}, {-9, 0}, {-11, 0}, {-13, 0}},
      {{5, 0}, {7, 0}, {9, 0}, {11, 0}, {13, 0}},
      {{-5, -6},
       {-7, -6},
       {-7, -8},
       {-9, -8},
       {-9, -10},
       {-11, -10},
       {-11, -12},
       {-13, -12}},
      {{6, -5},
       {6, -7},
       {8, -7},
       {8, -9},
       {10, -9},
       {10, -11},
       {12, -11},
       {12, -13}},
      {{5, 6}, {7, 6}, {7, 8}, {9, 8}, {9, 10}, {11, 10}, {11, 12}, {13, 12}},
      {{-6, 5},
       {-6, 7},
       {-8, 7},
       {-8, 9},
       {-10, 9},
       {-10, 11},
       {-12, 11},
       {-12, 13}}};
  EXPECT_THAT(Regions(MakeSamplingPattern(true, true), 0),
              testing::UnorderedElementsAreArray(expected));
}

TEST(Nesp, LooksAtNothingWithinDistanceFour) {
  for (const auto& region : Regions(MakeSamplingPattern(true, true), 3)) {
    for (const auto& [col, row] : region) {
      EXPECT_GT(std::max(std::abs(col), std::abs(row)), 4);
    }
  }
}

TEST(Nesp, RegionsDoubleFromFiveAndEightSamples) {
  const SamplingPattern pattern = MakeSamplingPattern(true, true);
  for (int i = 0; i < kNumRegions; ++i) {
    const int base = pattern.num_base[i];
    EXPECT_EQ(base, i < 4 ? 5 : 8);
    EXPECT_EQ(CountAtMost(pattern, i), i < 4 ? 40 : 64);
    // Every sample goes on where the one before ended: two pixels further.
    const auto samples = Samples(pattern, i, CountAtMost(pattern, i));
    for (size_t k = 1; k < samples.size(); ++k) {
      EXPECT_EQ(std::abs(samples[k].first - samples[k - 1].first) +
                    std::abs(samples[k].second - samples[k - 1].second),
                2);
    }
  }
}

TEST(Nesp, FullyGrownStripsReach83Pixels) {
  const SamplingPattern pattern = MakeSamplingPattern(true, true);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(std::abs(pattern.dcol[i][39]) + std::abs(pattern.drow[i][39]),
              83);
  }
}

TEST(Acmh, StripsHaveElevenSamplesFromThreeTo23) {
  const SamplingPattern pattern = MakeSamplingPattern(false, false);
  EXPECT_EQ(pattern.mask_distance, 1);
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(pattern.num_base[i], 11);
    for (int k = 0; k < 11; ++k) {
      EXPECT_EQ(std::abs(pattern.dcol[i][k]) + std::abs(pattern.drow[i][k]),
                3 + 2 * k);
    }
  }
}

TEST(Acmh, VRegionsStartAtTheFourNeighbours) {
  const SamplingPattern pattern = MakeSamplingPattern(false, false);
  std::set<Offset> first;
  for (int i = 4; i < kNumRegions; ++i) {
    EXPECT_EQ(pattern.num_base[i], 7);
    first.insert({pattern.dcol[i][0], pattern.drow[i][0]});
  }
  EXPECT_EQ(first, (std::set<Offset>{{0, -1}, {0, 1}, {-1, 0}, {1, 0}}));
}

}  // namespace
}  // namespace hpm
