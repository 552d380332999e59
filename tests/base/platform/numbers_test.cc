#include "src/base/platform/numbers.h"

#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <locale.h>

namespace hpm {
namespace {

template <class Float>
struct Outcome {
  Float value = -77;
  size_t num_read = 0;
  std::errc error = {};
};

template <class Float>
Outcome<Float> Read(const std::string& text) {
  Outcome<Float> out;
  const auto [end, error] =
      FloatFromChars(text.data(), text.data() + text.size(), &out.value);
  out.num_read = static_cast<size_t>(end - text.data());
  out.error = error;
  return out;
}

// What the wanted outcome is: number, characters read, error.
template <class Float>
void ExpectNumber(const std::string& text, Float value, size_t num_read) {
  const Outcome<Float> out = Read<Float>(text);
  EXPECT_EQ(out.error, std::errc()) << text;
  EXPECT_EQ(out.num_read, num_read) << text;
  EXPECT_EQ(std::memcmp(&out.value, &value, sizeof(value)), 0)
      << text << ": " << out.value;
}

TEST(FloatFromChars, ReadsWhatIsANumberAndStopsBehindIt) {
  ExpectNumber<double>("1.5", 1.5, 3);
  ExpectNumber<double>("-0", -0.0, 2);
  ExpectNumber<double>(".5x", 0.5, 2);
  ExpectNumber<double>("5.", 5, 2);
  ExpectNumber<double>("1e3 2", 1000, 3);
  ExpectNumber<double>("1,5", 1, 1);
  ExpectNumber<double>("0x10", 0, 1);
  ExpectNumber<double>("-0x10", -0.0, 2);
  ExpectNumber<double>("4e-320", 4e-320, 6);
  ExpectNumber<float>("3.4028235e38", 3.4028235e38f, 12);
  ExpectNumber<double>("inf", INFINITY, 3);
  ExpectNumber<double>("-INFINITY", -INFINITY, 9);
  EXPECT_TRUE(std::isnan(Read<double>("nan").value));
  EXPECT_TRUE(std::isnan(Read<float>("NaN").value));
}

TEST(FloatFromChars, LeavesTheValueAloneWhereThereIsNone) {
  for (const char* text :
       {"", " 1", "+1", "-", "e5", "x", "--1", "-+1", "\t1", ".", "- 1"}) {
    const Outcome<double> out = Read<double>(text);
    EXPECT_EQ(out.error, std::errc::invalid_argument) << text;
    EXPECT_EQ(out.num_read, 0u) << text;
    EXPECT_EQ(out.value, -77) << text;
  }
  for (const char* text : {"1e400", "-1e400", "1e-400"}) {
    const Outcome<double> out = Read<double>(text);
    EXPECT_EQ(out.error, std::errc::result_out_of_range) << text;
    EXPECT_EQ(out.num_read, std::strlen(text)) << text;
    EXPECT_EQ(out.value, -77) << text;
  }
  EXPECT_EQ(Read<float>("1e39").error, std::errc::result_out_of_range);
}

// The locale of the C library must not matter.
TEST(FloatFromChars, ReadsAPointWhereOthersWriteAComma) {
  const std::string before = setlocale(LC_NUMERIC, nullptr);
  bool found = false;
  for (const char* name :
       {"de_DE.UTF-8", "de_DE.utf8", "fr_FR.UTF-8", "German_Germany.1252"}) {
    found = found || setlocale(LC_NUMERIC, name) != nullptr;
  }
  ExpectNumber<double>("1.5", 1.5, 3);
  setlocale(LC_NUMERIC, before.c_str());
  if (!found) GTEST_SKIP() << "no locale with a comma is installed";
}

#ifdef __cpp_lib_to_chars
// Where the standard library has its own, both say the same.
TEST(FloatFromChars, SaysWhatTheStandardLibrarySays) {
  std::mt19937 random(1);
  const std::string letters = "0123456789+-.eExXinfat ,";
  for (int i = 0; i < 200000; ++i) {
    std::string text;
    for (unsigned n = random() % 8; n > 0; --n)
      text += letters[random() % letters.size()];
    if (text.find("nan(") != std::string::npos) continue;
    double wanted = -77;
    const auto [end, error] =
        std::from_chars(text.data(), text.data() + text.size(), wanted);
    const Outcome<double> out = Read<double>(text);
    ASSERT_EQ(out.error, error) << '"' << text << '"';
    ASSERT_EQ(out.num_read, static_cast<size_t>(end - text.data()))
        << '"' << text << '"';
    if (std::isnan(wanted)) {
      ASSERT_TRUE(std::isnan(out.value)) << '"' << text << '"';
    } else {
      ASSERT_EQ(out.value, wanted) << '"' << text << '"';
    }
  }
}
#endif

TEST(FromChars, ReadsWholeNumbersToo) {
  const std::string text = "42";
  int value = 0;
  FromChars(text.data(), text.data() + text.size(), &value);
  EXPECT_EQ(value, 42);
}

}  // namespace
}  // namespace hpm
