#include "src/base/huge_pages.h"

#include <cstdint>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace hpm {
namespace {

using Vector = std::vector<uint16_t, HugePageAllocator<uint16_t>>;

// Below, at and above the size from which pages are huge, and not a whole
// number of them.
class HugePages : public testing::TestWithParam<size_t> {};
INSTANTIATE_TEST_SUITE_P(Bytes,
                         HugePages,
                         testing::Values(2,
                                         kHugePage - 2,
                                         kHugePage,
                                         kHugePage + 2,
                                         3 * kHugePage + 1000));

TEST_P(HugePages, HoldWhatIsWrittenAndCanBeCopiedAndMoved) {
  Vector values(GetParam() / sizeof(uint16_t));
  std::iota(values.begin(), values.end(), uint16_t{1});
  const Vector copy = values;
  const Vector moved = std::move(values);
  EXPECT_EQ(copy, moved);
  EXPECT_EQ(copy.back(), static_cast<uint16_t>(GetParam() / 2));
}

TEST_P(HugePages, LargeArraysBeginOnAHugePage) {
  const Vector values(GetParam() / sizeof(uint16_t));
  if (GetParam() < kHugePage) GTEST_SKIP() << "an ordinary array";
  EXPECT_EQ(reinterpret_cast<uintptr_t>(values.data()) % kHugePage, 0u);
}

}  // namespace
}  // namespace hpm
