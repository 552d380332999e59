#include "colmap_plugin/controller/unreadable_images.h"

#include "tests/colmap_plugin/controller/controller_fixture.h"

#include <gmock/gmock.h>

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class UnreadableImagesTest : public ControllerTest {
 protected:
  std::filesystem::path File(int image) const {
    return scene_.path() / "images" / ViewName(image);
  }
  void Damage(int image) { std::filesystem::resize_file(File(image), 60); }
  // What decoding said of all images, and what is known of them afterwards.
  std::vector<std::string> Remembered() {
    Workspace workspace(options_.workspace, nullptr);
    ImageContents contents(workspace);
    contents.Read({0, 1, 2, 3}, cancel_);
    for (int image = 0; image < kNumImages; ++image)
      RecordUnreadable(workspace, contents, image, ViewName(image));
    return DropUnreadable(&workspace, &contents, cancel_);
  }
};

// The disk may have failed for a moment.
TEST_F(UnreadableImagesTest, GoodOnesAreNotRemembered) {
  EXPECT_THAT(Remembered(), IsEmpty());
  Damage(1);
  EXPECT_THAT(Remembered(), ElementsAre(ViewName(1)));
}

TEST_F(UnreadableImagesTest,
       ContentsThatChangedSinceAreNotTakenForTheDamagedOnes) {
  Workspace workspace(options_.workspace, nullptr);
  ImageContents contents(workspace);
  contents.Read({0, 1, 2, 3}, cancel_);
  Damage(2);
  RecordUnreadable(workspace, contents, 2, "damaged");
  EXPECT_THAT(DropUnreadable(&workspace, &contents, cancel_), IsEmpty());
}

TEST_F(UnreadableImagesTest, RecordsOfMendedImagesGo) {
  const std::filesystem::path folder =
      scene_.path() / "stereo/hpm_mvs/unreadable_images";
  Damage(1);
  Damage(3);
  EXPECT_EQ(Remembered().size(), 2u);
  std::filesystem::copy_file(
      File(0), File(1), std::filesystem::copy_options::overwrite_existing);
  for (const bool is_mended : {false, true}) {
    if (is_mended) {
      std::filesystem::copy_file(
          File(0), File(3), std::filesystem::copy_options::overwrite_existing);
    }
    Workspace workspace(options_.workspace, nullptr);
    ImageContents contents(workspace);
    EXPECT_EQ(DropUnreadable(&workspace, &contents, cancel_).size(),
              is_mended ? 0u : 1u);
    ForgetMended(workspace, contents);
    EXPECT_EQ(std::filesystem::exists(folder), !is_mended);
  }
}

TEST_F(UnreadableImagesTest, FilesThatEndTooEarlyAreFoundWithoutARecord) {
  Damage(2);
  Workspace workspace(options_.workspace, nullptr);
  EXPECT_THAT(DropTruncated(&workspace, cancel_),
              ElementsAre(HasSubstr(ViewName(2))));
  EXPECT_FALSE(workspace.has_picture(2));
  EXPECT_TRUE(workspace.has_picture(1));
}

}  // namespace
}  // namespace hpm
