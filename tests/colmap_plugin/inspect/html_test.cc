#include "colmap_plugin/inspect/html.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

TEST(Html, NoTextBecomesMarkup) {
  EXPECT_EQ(Html("<b a=\"1\" b='2'>&amp;"),
            "&lt;b a=&quot;1&quot; b=&#39;2&#39;&gt;&amp;amp;");
}

TEST(Html, KeepsUtf8AndNothingElse) {
  EXPECT_EQ(Html("\xc3\xa4 \xe2\x82\xac \xf0\x9f\x8f\xa0"),
            "\xc3\xa4 \xe2\x82\xac \xf0\x9f\x8f\xa0");
  const std::string unknown = "\xEF\xBF\xBD";
  for (const char* bad : {"\xff", "\x80", "\x01", "\n", "\x7f", "\xc3"})
    EXPECT_EQ(Html(bad), unknown);
  // A slash written too long, a surrogate, a control character.
  EXPECT_EQ(Html("\xe0\x80\xaf"), unknown + unknown + unknown);
  EXPECT_EQ(Html("\xed\xa0\x80"), unknown + unknown + unknown);
  EXPECT_EQ(Html("\xc2\x85"), unknown + unknown);
}

TEST(Base64, IsPadded) {
  EXPECT_EQ(Base64(""), "");
  EXPECT_EQ(Base64("M"), "TQ==");
  EXPECT_EQ(Base64("Ma"), "TWE=");
  EXPECT_EQ(Base64("Man"), "TWFu");
  EXPECT_EQ(Base64("\xff\xfe\xfd\xfc"), "//79/A==");
}

}  // namespace
}  // namespace hpm
