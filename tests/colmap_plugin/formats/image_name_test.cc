#include "colmap_plugin/formats/image_name.h"

#include "tests/colmap_plugin/formats/test_files.h"

namespace hpm {
namespace {

TEST(ImageName, RelativeNamesAreLegal) {
  for (const char* name : {"a.jpg",
                           "cam1/day 2/x.jpg",
                           "./a.jpg",
                           "a//b.jpg",
                           "..a.jpg",
                           "a../b..jpg",
                           "\xC3\xA4\xE2\x82\xAC.jpg",
                           "a,b;c.jpg"}) {
    EXPECT_NO_THROW(CheckImageName(name)) << name;
  }
}

TEST(ImageName, NamesThatLeaveTheFolderOrNameOneAreRefused) {
  for (const std::string& name : {std::string(),
                                  std::string("/etc/passwd"),
                                  std::string(".."),
                                  std::string("../a.jpg"),
                                  std::string("a/../../b.jpg"),
                                  std::string("a/.."),
                                  std::string("."),
                                  std::string("a/"),
                                  std::string("a/."),
                                  std::string("a\nb.jpg"),
                                  std::string("a\x1b[2Jb.jpg"),
                                  std::string("a\0.jpg", 6),
                                  std::string("a\x7f")}) {
    SCOPED_TRACE(QuotedName(name));
    ExpectError(
        ErrorCode::kBadInput, "image name", [&] { CheckImageName(name); });
  }
}

TEST(ImageName, QuotedNamesAreShortAndPrintable) {
  EXPECT_EQ(QuotedName("a\n\x1b.jpg"), "'a\\x0a\\x1b.jpg'");
  EXPECT_LT(QuotedName(std::string(1 << 20, 'a')).size(), 120u);
}

}  // namespace
}  // namespace hpm
