#include "colmap_plugin/controller/image_contents.h"

#include "tests/colmap_plugin/controller/scene_workspace.h"

#include <gtest/gtest.h>

namespace hpm {
namespace {

class ImageContentsTest : public testing::Test {
 protected:
  SceneWorkspace scene_{SmallScene(3, 12, 9)};
  Workspace workspace_ = scene_.Open();
  ImageContents contents_{workspace_};
  CancelToken cancel_;
};

TEST_F(ImageContentsTest, TellsImagesOfTheSameLengthApart) {
  WriteFile(workspace_.ImagePath(0), "one");
  WriteFile(workspace_.ImagePath(1), "two");
  WriteFile(workspace_.ImagePath(2), "one");
  contents_.Read({0, 1, 2, 1}, cancel_);
  EXPECT_FALSE(contents_.HashOf(0).empty());
  EXPECT_NE(contents_.HashOf(0), contents_.HashOf(1));
  EXPECT_EQ(contents_.HashOf(0), contents_.HashOf(2));
}

TEST_F(ImageContentsTest, ReadsWhatItIsAskedForOnce) {
  contents_.Read({0}, cancel_);
  const std::string hash = contents_.HashOf(0);
  EXPECT_EQ(contents_.HashOf(1), "");
  EXPECT_TRUE(contents_.IsUnchanged(0));
  EXPECT_FALSE(contents_.IsUnchanged(1));
  WriteFile(workspace_.ImagePath(0), "another");
  contents_.Read({0, 1}, cancel_);
  EXPECT_EQ(contents_.HashOf(0), hash);
  EXPECT_FALSE(contents_.IsUnchanged(0));
  EXPECT_TRUE(contents_.IsUnchanged(1));
}

// Decoding says what is wrong.
TEST_F(ImageContentsTest, GoesOnWithoutAFileThatCannotBeRead) {
  std::filesystem::remove(workspace_.ImagePath(1));
  contents_.Read({0, 1, 2}, cancel_);
  EXPECT_EQ(contents_.HashOf(1), "");
  EXPECT_FALSE(contents_.IsUnchanged(1));
  EXPECT_FALSE(contents_.HashOf(2).empty());
}

TEST_F(ImageContentsTest, HearsCancel) {
  cancel_.Cancel();
  EXPECT_THROW(contents_.Read({0, 1}, cancel_), Error);
}

}  // namespace
}  // namespace hpm
