#include "colmap_plugin/controller/cost_histogram.h"

#include <limits>

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(CostHistogram, CountsByTenthsAndPutsWhatIsBeyondIntoTheLast) {
  CostHistogram histogram;
  for (const float cost :
       {-1e-6f, 0.0f, 0.05f, 0.15f, 1.95f, 2.0f, 2.4f, 1e30f})
    histogram.Add(cost);
  histogram.Add(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(histogram.bins[0], 3u);
  EXPECT_EQ(histogram.bins[1], 1u);
  EXPECT_EQ(histogram.bins[kNumCostBins - 1], 5u);
  EXPECT_EQ(histogram.Count(), 9u);
}

TEST(CostHistogram, HasAMedian) {
  CostHistogram histogram;
  EXPECT_EQ(histogram.Median(), 0);
  histogram.bins[3] = 1;
  EXPECT_NEAR(histogram.Median(), 0.35, 1e-6);
  histogram.bins[10] = 3;
  EXPECT_NEAR(histogram.Median(), 1 + 0.1 / 3, 1e-6);
}

TEST(CostHistogram, IsReadAsItIsWritten) {
  CostHistogram histogram;
  histogram.bins[0] = 7;
  histogram.bins[19] = 5;
  const auto json = nlohmann::json::parse(ToJson(histogram).dump());
  EXPECT_EQ(CostHistogramFrom(json).value().bins, histogram.bins);
  // More pixels than an image can have.
  histogram.bins[19] = 1234567890123;
  EXPECT_FALSE(CostHistogramFrom(ToJson(histogram)));
}

TEST(CostHistogram, WhatIsNoneIsNotRead) {
  nlohmann::json good = ToJson(CostHistogram());
  EXPECT_TRUE(CostHistogramFrom(good));
  for (const char* text : {"null", "3", "[]", "[1]", "{}", "\"\""})
    EXPECT_FALSE(CostHistogramFrom(nlohmann::json::parse(text))) << text;
  for (const char* value : {"-1", "0.5", "\"1\"", "null", "[]"}) {
    nlohmann::json bad = good;
    bad[5] = nlohmann::json::parse(value);
    EXPECT_FALSE(CostHistogramFrom(bad)) << value;
  }
}

}  // namespace
}  // namespace hpm
