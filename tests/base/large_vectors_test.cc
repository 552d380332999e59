#include "src/base/large_vectors.h"

#include <algorithm>
#include <numeric>

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(LargeVectors, HoldWhatOthersWould) {
  for (const size_t size : {size_t{0},
                            size_t{1},
                            size_t{5000},
                            kHugePage / sizeof(int),
                            3 * kHugePage / sizeof(int) + 17}) {
    std::vector<int> numbers = Filled(size, 7);
    ASSERT_EQ(numbers, std::vector<int>(size, 7));
    std::iota(numbers.begin(), numbers.end(), 1);
    ASSERT_EQ(Copied(numbers), numbers);
    EXPECT_EQ(Copied(numbers).capacity(), size);
  }
}

// What is touched lies within what was asked for, wherever that begins.
TEST(LargeVectors, TouchNothingElse) {
  std::vector<char> bytes(3 * kHugePage, 1);
  for (const size_t begin : {size_t{1}, size_t{4095}, kHugePage - 1}) {
    for (const size_t size : {size_t{0}, size_t{1}, kHugePage + 1}) {
      std::fill(bytes.begin(), bytes.end(), char{1});
      TouchPages(bytes.data() + begin, size);
      const auto first = bytes.begin() + static_cast<ptrdiff_t>(begin);
      EXPECT_EQ(std::count(bytes.begin(), first, 0), 0);
      EXPECT_EQ(
          std::count(first + static_cast<ptrdiff_t>(size), bytes.end(), 0), 0);
      EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 0) > 0, size > 0);
    }
  }
}

}  // namespace
}  // namespace hpm
