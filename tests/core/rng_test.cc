#include "src/core/rng.h"

#include <array>
#include <cmath>
#include <functional>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kSide = 400;  // streams per axis in the statistics below

// Pearson's chi-squared of 64 bins; 63 degrees of freedom: mean 63, sigma 11.2.
double ChiSquared(const std::vector<float>& numbers) {
  std::array<int, 64> counts = {};
  for (const float u : numbers) ++counts[static_cast<int>(64 * u)];
  const double expected = static_cast<double>(numbers.size()) / 64;
  double sum = 0;
  for (const int count : counts) {
    sum += (count - expected) * (count - expected) / expected;
  }
  return sum;
}
constexpr double kChiSquaredBound = 63 + 5 * 11.2;

// Correlation of two sequences of uniform numbers, in standard deviations.
double Correlation(const std::vector<float>& a, const std::vector<float>& b) {
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] - 0.5) * (b[i] - 0.5);
  return sum * 12 / std::sqrt(static_cast<double>(a.size()));
}

// One number from each pixel's stream.
std::vector<float> FromEachPixel(
    const std::function<float(int col, int row)>& draw) {
  std::vector<float> numbers;
  for (int row = 0; row < kSide; ++row) {
    for (int col = 0; col < kSide; ++col) numbers.push_back(draw(col, row));
  }
  return numbers;
}

std::vector<float> FirstNumbers(uint64_t key) {
  return FromEachPixel(
      [key](int col, int row) { return Rng(key, col, row).Uniform(); });
}

TEST(Rng, SameKeyAndPixelGiveTheSameNumbers) {
  Rng a(42, 7, 9);
  Rng b(42, 7, 9);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.Uniform(), b.Uniform());
}

// The numbers are part of the results; a change of them is a change of all
// maps.
TEST(Rng, StreamIsFixedForever) {
  // SplitMix64 of seed 1234567, known from its reference implementation.
  uint64_t state = 1234567;
  state += 0x9E3779B97F4A7C15ull;
  EXPECT_EQ(MixBits(state), 6457827717110365317ull);
  state += 0x9E3779B97F4A7C15ull;
  EXPECT_EQ(MixBits(state), 3203168211198807973ull);
}

TEST(Rng, NumbersOfOneStreamAreUniformInTheHalfOpenUnitInterval) {
  Rng rng(3, 11, 5);
  std::vector<float> numbers;
  for (int i = 0; i < kSide * kSide; ++i) {
    numbers.push_back(rng.Uniform());
    ASSERT_GE(numbers.back(), 0.0f);
    ASSERT_LT(numbers.back(), 1.0f);
  }
  EXPECT_LT(ChiSquared(numbers), kChiSquaredBound);
}

TEST(Rng, FirstNumbersOfNeighbouringPixelsAreUniform) {
  for (const uint64_t key : {0ull, 1ull, 0xFFFFFFFFFFFFFFFFull}) {
    EXPECT_LT(ChiSquared(FirstNumbers(key)), kChiSquaredBound);
  }
}

TEST(Rng, NeighbouringStreamsAreUncorrelated) {
  const std::vector<float> here = FirstNumbers(5);
  const std::vector<float> right = FromEachPixel(
      [](int col, int row) { return Rng(5, col + 1, row).Uniform(); });
  const std::vector<float> below = FromEachPixel(
      [](int col, int row) { return Rng(5, col, row + 1).Uniform(); });
  const std::vector<float> transposed = FromEachPixel(
      [](int col, int row) { return Rng(5, row, col + 1000).Uniform(); });
  const std::vector<float> second = FromEachPixel([](int col, int row) {
    Rng rng(5, col, row);
    rng.Uniform();
    return rng.Uniform();
  });
  for (const auto& other : {right, below, transposed, second}) {
    EXPECT_LT(std::abs(Correlation(here, other)), 4);
  }
}

TEST(Rng, NeighbouringKeysGiveUncorrelatedStreams) {
  const std::vector<float> base = FirstNumbers(CombineBits(1, 0));
  for (const uint64_t key :
       {CombineBits(1, 1), CombineBits(0, 1), CombineBits(2, 0)}) {
    EXPECT_LT(std::abs(Correlation(base, FirstNumbers(key))), 4);
  }
}

TEST(Rng, PixelIsNotReducedToASumOrAnIndex) {
  EXPECT_NE(Rng(1, 2, 3).Uniform(), Rng(1, 3, 2).Uniform());
  EXPECT_NE(Rng(1, 0, 1).Uniform(), Rng(1, 1, 0).Uniform());
  EXPECT_NE(CombineBits(1, 2), CombineBits(2, 1));
}

TEST(Rng, RangeFormStaysWithinItsEnds) {
  Rng rng(1, 0, 0);
  double sum = 0;
  for (int i = 0; i < 10000; ++i) {
    const float v = rng.Uniform(-3.0f, 5.0f);
    ASSERT_GE(v, -3.0f);
    ASSERT_LE(v, 5.0f);
    sum += v;
  }
  EXPECT_NEAR(sum / 10000, 1.0, 4 * 8 / std::sqrt(12.0 * 10000));
}

}  // namespace
}  // namespace hpm
