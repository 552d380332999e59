#include "colmap_plugin/workspace/fingerprint.h"

#include <limits>
#include <set>

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

// FNV-1a as published, on 128-bit integers.
std::string Fnv1a128(const std::string& bytes) {
  using Word = unsigned __int128;
  const Word prime = (static_cast<Word>(1) << 88) + 0x13b;
  Word hash =
      (static_cast<Word>(0x6c62272e07bb0142u) << 64) + 0x62b821756295c58du;
  for (const char c : bytes)
    hash = (hash ^ static_cast<unsigned char>(c)) * prime;
  return fmt::format("{:016x}{:016x}",
                     static_cast<uint64_t>(hash >> 64),
                     static_cast<uint64_t>(hash));
}

TEST(Fingerprint, OfNothingIsTheOffsetBasis) {
  EXPECT_EQ(Fingerprint().Hex(), "6c62272e07bb014262b821756295c58d");
}

TEST(Fingerprint, IsFnv1aOfKindLengthAndBytes) {
  const std::string text = "a longer text with \xff bytes";
  EXPECT_EQ(Fingerprint().AddString(text).Hex(),
            Fnv1a128("s" + std::string(1, static_cast<char>(text.size())) +
                     std::string(7, '\0') + text));
  EXPECT_EQ(Fingerprint().AddInt(-2).Hex(),
            Fnv1a128("i\xfe\xff\xff\xff\xff\xff\xff\xff"));
}

TEST(Fingerprint, NeighbouringValuesDoNotRunIntoEachOther) {
  std::set<std::string> all;
  all.insert(Fingerprint().AddString("ab").AddString("c").Hex());
  all.insert(Fingerprint().AddString("a").AddString("bc").Hex());
  all.insert(Fingerprint().AddString("abc").Hex());
  all.insert(Fingerprint().AddString("abc").AddString("").Hex());
  all.insert(Fingerprint().AddInt(1).Hex());
  all.insert(Fingerprint().AddDouble(1).Hex());
  all.insert(Fingerprint().AddInt(1).AddInt(2).Hex());
  all.insert(Fingerprint().AddInt(2).AddInt(1).Hex());
  EXPECT_EQ(all.size(), 8u);
}

TEST(Fingerprint, EqualNumbersAreEqual) {
  EXPECT_EQ(Fingerprint().AddDouble(0.0).Hex(),
            Fingerprint().AddDouble(-0.0).Hex());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(Fingerprint().AddDouble(nan).Hex(),
            Fingerprint().AddDouble(-nan).Hex());
  EXPECT_NE(Fingerprint().AddDouble(1).Hex(),
            Fingerprint().AddDouble(1 + 1e-15).Hex());
}

}  // namespace
}  // namespace hpm
