#include "colmap_plugin/options/option_value.h"

#include "tests/colmap_plugin/tool/comma_locale.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(OptionValueTest, BooleansAreColmapsWordsInAnyCase) {
  bool value = false;
  for (const char* word : {"1", "true", "TRUE", "yes", "Yes", "on", "oN"}) {
    value = false;
    EXPECT_TRUE(ParseValue(word, &value)) << word;
    EXPECT_TRUE(value) << word;
  }
  for (const char* word : {"0", "false", "False", "no", "NO", "off"}) {
    value = true;
    EXPECT_TRUE(ParseValue(word, &value)) << word;
    EXPECT_FALSE(value) << word;
  }
  value = true;
  for (const char* word : {"", "2", "t", "yess", " 1", "-1"}) {
    EXPECT_FALSE(ParseValue(word, &value)) << word;
    EXPECT_TRUE(value) << word;
  }
}

TEST(OptionValueTest, IntegersAreWholeAndFitInInt) {
  int value = 7;
  for (const char* word : {"",
                           "3.5",
                           "1e2",
                           "x",
                           "3x",
                           " 3",
                           "3 ",
                           "2147483648",
                           "--3",
                           "+",
                           "+-3",
                           "0x10"}) {
    EXPECT_FALSE(ParseValue(word, &value)) << word;
    EXPECT_EQ(value, 7) << word;
  }
  EXPECT_TRUE(ParseValue("-2147483648", &value));
  EXPECT_EQ(value, -2147483647 - 1);
  EXPECT_TRUE(ParseValue("+5", &value));
  EXPECT_EQ(value, 5);
}

TEST(OptionValueTest, FloatsAreFinite) {
  double value = 7;
  for (const char* word : {"",
                           "nan",
                           "NaN",
                           "-nan",
                           "inf",
                           "-inf",
                           "infinity",
                           "1e999",
                           "1e39",
                           "1,5",
                           "1.5 ",
                           "0x1p3"}) {
    EXPECT_FALSE(ParseValue(word, &value)) << word;
    EXPECT_EQ(value, 7) << word;
  }
  EXPECT_TRUE(ParseValue("1e-2", &value));
  EXPECT_EQ(value, 0.01);
  EXPECT_TRUE(ParseValue("-.5", &value));
  EXPECT_EQ(value, -0.5);
}

TEST(OptionValueTest, StringsRefuseNul) {
  std::string value;
  EXPECT_FALSE(ParseValue(std::string_view("a\0b", 3), &value));
  EXPECT_TRUE(ParseValue("a b", &value));
  EXPECT_EQ(value, "a b");
}

TEST(OptionValueTest, GlobalLocaleChangesNothing) {
  const CommaLocale comma;
  double value = 0;
  EXPECT_TRUE(ParseValue("1234.5", &value));
  EXPECT_EQ(value, 1234.5);
  EXPECT_EQ(FormatValue(&value), "1234.5");
  int number = 12345;
  EXPECT_EQ(FormatValue(&number), "12345");
  EXPECT_EQ(Between(0.5, 1000).text, "0.5 to 1000");
}

TEST(OptionValueTest, RangesTakeTheirEndsAsTheirTextSays) {
  const auto contains = [](const Allowed& allowed, double value) {
    return allowed.contains(&value);
  };
  EXPECT_TRUE(contains(AtLeast(0), 0));
  EXPECT_FALSE(contains(AtLeast(0), -1e-9));
  EXPECT_FALSE(contains(Above(0), 0));
  EXPECT_TRUE(contains(Above(0), 1e-9));
  EXPECT_TRUE(contains(Between(-1, 1), -1));
  EXPECT_TRUE(contains(Between(-1, 1), 1));
  EXPECT_FALSE(contains(Between(-1, 1), 1.001));
  EXPECT_TRUE(contains(BetweenBelow(0, 180), 0));
  EXPECT_FALSE(contains(BetweenBelow(0, 180), 180));
}

}  // namespace
}  // namespace hpm
