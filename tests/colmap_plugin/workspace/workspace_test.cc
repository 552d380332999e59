#include "colmap_plugin/workspace/workspace.h"

#include "colmap_plugin/formats/patch_match_cfg.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

namespace hpm {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Workspace, KnowsWhereFilesLie) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("cam1/day2/x.jpg", {1, 0, 0});
  const Workspace workspace = files.Open();
  const auto root = files.path();
  EXPECT_EQ(workspace.ImageIndex("cam1/day2/x.jpg"), 1);
  EXPECT_EQ(workspace.ImageIndex("x.jpg"), -1);
  EXPECT_EQ(workspace.ImagePath(1), root / "images/cam1/day2/x.jpg");
  EXPECT_EQ(workspace.MapPath(1, MapKind::kDepth, "geometric"),
            root / "stereo/depth_maps/cam1/day2/x.jpg.geometric.bin");
  EXPECT_EQ(workspace.MapPath(0, MapKind::kNormal, "photometric"),
            root / "stereo/normal_maps/a.jpg.photometric.bin");
  EXPECT_EQ(workspace.MapPath(0, MapKind::kConsistencyGraph, "geometric"),
            root / "stereo/consistency_graphs/a.jpg.geometric.bin");
  EXPECT_EQ(workspace.StatePath(), root / "stereo/hpm_mvs");
}

// All with one fault: one line, which tells their number and what became of the
// first.
TEST(Workspace, MissingImageFilesAreNamedInOneLine) {
  struct Case {
    const char* name;
    const char* there;  // in images/ instead
    std::vector<const char*> words;
  };
  for (const Case& c : {Case{"b.JPG", "b.jpg", {"'b.jpg'", "case"}},
                        Case{"b.JPG", "b.png", {"'b.png'", "extension"}},
                        Case{"D:\\x\\b.jpg", "b.jpg", {"relative"}},
                        Case{"b.jpg", "", {"undistort"}}}) {
    SCOPED_TRACE(c.name + std::string(" ") + c.there);
    TestWorkspace files;
    files.AddImage("a.jpg", {0, 0, 0});
    files.AddImage(c.name, {1, 0, 0});
    files.AddImage("sub/c.jpg", {2, 0, 0});
    files.LeaveOutFile(c.name);
    files.LeaveOutFile("sub/c.jpg");
    if (*c.there) WriteFile(files.path() / "images" / c.there, "x");
    const Workspace workspace = files.Open();
    EXPECT_TRUE(workspace.has_picture(0));
    EXPECT_FALSE(workspace.has_picture(1));
    EXPECT_TRUE(workspace.usable(1));
    EXPECT_EQ(workspace.camera(1).width, 160);
    ASSERT_EQ(files.Warnings().size(), 1u);
    EXPECT_THAT(files.Warnings()[0], HasSubstr("2 of 3 images"));
    EXPECT_THAT(files.Warnings()[0], HasSubstr(c.name));
    for (const char* word : c.words)
      EXPECT_THAT(files.Warnings()[0], HasSubstr(word));
  }
}

TEST(Workspace, WithoutAnyImageFileIsAnErrorThatTellsWhy) {
  for (const bool with_folder : {false, true}) {
    TestWorkspace files;
    for (const char* name : {"a.jpg", "b.jpg"}) {
      files.AddImage(name, {0, 0, 0});
      files.LeaveOutFile(name);
    }
    if (with_folder) {
      std::filesystem::create_directories(files.path() / "images");
      std::filesystem::create_symlink("/nowhere/a.jpg",
                                      files.path() / "images/a.jpg");
    }
    const auto error = ErrorOf([&] { files.Open(); });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), HasSubstr("2 of 2"));
    EXPECT_THAT(
        error->what(),
        HasSubstr(with_folder ? "/nowhere/a.jpg" : "images is missing"));
    EXPECT_THAT(files.Warnings(), IsEmpty());
  }
}

TEST(Workspace, BackslashesOfWindowsStandForSlashes) {
  TestWorkspace files;
  for (const char* name : {"cam\\a.jpg", "cam/b.jpg", "cam\\c.jpg"})
    files.AddImage(name, {0, 0, 0});
  files.LeaveOutFile("cam\\a.jpg");
  WriteFile(files.path() / "images/cam/a.jpg", PngHeader(160, 120));
  const Workspace workspace = files.Open();
  EXPECT_EQ(workspace.ImagePath(0), files.path() / "images/cam/a.jpg");
  EXPECT_EQ(workspace.ImagePath(2), files.path() / "images/cam\\c.jpg");
  EXPECT_EQ(workspace.ImageIndex("cam/a.jpg"), 0);
  EXPECT_EQ(workspace.ImageIndex("cam\\a.jpg"), 0);
  EXPECT_EQ(workspace.ImageIndex("cam\\b.jpg"), 1);
  // Where stereo_fusion looks.
  EXPECT_EQ(workspace.MapPath(0, MapKind::kDepth, "geometric").filename(),
            "cam\\a.jpg.geometric.bin");
  EXPECT_THAT(files.Warnings(),
              ElementsAre(testing::AllOf(HasSubstr("1 of 3"),
                                         HasSubstr("cam\\a.jpg"),
                                         HasSubstr("stereo_fusion"))));
}

TEST(Workspace, BackslashesCannotLeaveTheFolder) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("..\\outside.jpg", {1, 0, 0});
  WriteFile(files.path() / "outside.jpg", PngHeader(160, 120));
  EXPECT_FALSE(files.Open().has_picture(1));
}

TEST(Workspace, ScalesCamerasToTheImageFilesWithOneNote) {
  TestWorkspace files;
  for (const char* name : {"a.png", "b.png", "c.png"})
    files.AddImage(name, {0, 0, 0});
  WriteFile(files.path() / "images/a.png", PngHeader(160, 120));
  WriteFile(files.path() / "images/b.png", PngHeader(100, 75));
  WriteFile(files.path() / "images/c.png", PngHeader(320, 240));
  const Workspace workspace = files.Open();
  EXPECT_EQ(workspace.camera(0).width, 160);
  EXPECT_EQ(workspace.camera(1).width, 100);
  EXPECT_FLOAT_EQ(workspace.camera(1).fx, 62.5f);
  EXPECT_FLOAT_EQ(workspace.camera(1).cx, 49.5f);
  EXPECT_EQ(workspace.camera(2).width, 320);
  EXPECT_THAT(files.Warnings(), IsEmpty());
  EXPECT_THAT(files.Notes(), ElementsAre(HasSubstr("2 of 3 images")));
  EXPECT_THAT(files.Notes()[0],
              HasSubstr("b.png is 100x75, its camera 160x120"));
}

TEST(Workspace, PicturesOfOtherProportionsAreNotUsed) {
  struct Case {
    uint32_t width, height;
    bool fits;
  };
  for (const Case& c : {Case{120, 160, false},  // turned
                        Case{150, 120, false},  // cut
                        Case{164, 124, true},   // by rounding at most
                        Case{107, 80, true},
                        Case{1, 1, true},
                        Case{1601, 1199, true},
                        Case{1600, 1230, false}}) {
    SCOPED_TRACE(fmt::format("{}x{}", c.width, c.height));
    TestWorkspace files;
    files.AddImage("a.png", {0, 0, 0});
    files.AddImage("b.png", {1, 0, 0});
    WriteFile(files.path() / "images/b.png", PngHeader(c.width, c.height));
    EXPECT_EQ(files.Open().has_picture(1), c.fits);
    EXPECT_EQ(files.Warnings().empty(), c.fits);
    if (c.fits) continue;
    EXPECT_THAT(files.Warnings(),
                ElementsAre(testing::AllOf(
                    HasSubstr("1 of 2 images"),
                    HasSubstr(fmt::format("b.png is {}x{}", c.width, c.height)),
                    HasSubstr("rotation"),
                    HasSubstr("EXIF"))));
  }
}

TEST(Workspace, UnusableImagesKeepTheirIndexAndAreNamed) {
  TestWorkspace files;
  files.AddCamera(2, "OPENCV_FISHEYE 160 120 100 100 80 60 0 0 0 0");
  files.AddCamera(3, "PINHOLE 160 120 -100 100 80 60");
  files.AddImage("fisheye.jpg", {0, 0, 0}, 2);
  files.AddImage("negative.jpg", {0, 0, 0}, 3);
  files.AddImagePose("nan.jpg", "1 0 0 0 nan 0 0");
  files.AddImagePose("zero.jpg", "0 0 0 0 0 0 0");
  files.AddImage("good.jpg", {0, 0, 0});
  files.AddImage("twin.jpg", {0, 0, 0});
  const Workspace workspace = files.Open();
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(workspace.usable(i)) << i;
  EXPECT_TRUE(workspace.usable(4));
  EXPECT_TRUE(workspace.usable(5));  // the same place twice is legal
  EXPECT_EQ(workspace.ImageIndex("good.jpg"), 4);
  // One line for each fault, with its first image.
  EXPECT_THAT(files.Warnings(),
              testing::UnorderedElementsAre(
                  HasSubstr("1 of 6 images not used, the first: fisheye.jpg"),
                  HasSubstr("2 of 6 images not used, the first: negative.jpg"),
                  HasSubstr("1 of 6 images not used, the first: zero.jpg")));
}

TEST(Workspace, OneFaultOfManyCamerasIsOneWarning) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  for (int camera = 2; camera < 6; ++camera) {
    files.AddCamera(
        camera,
        fmt::format("OPENCV 160 120 100 100 80 60 0.0{} 0 0 0", camera));
    files.AddImage(fmt::format("{}.jpg", camera), {0, 0, 0}, camera);
  }
  files.Open();
  ASSERT_EQ(files.Warnings().size(), 1u);
  EXPECT_THAT(files.Warnings()[0], HasSubstr("4 of 5 images"));
  EXPECT_THAT(files.Warnings()[0], HasSubstr("2.jpg"));
  EXPECT_THAT(files.Warnings()[0], HasSubstr("image_undistorter"));
}

TEST(Workspace, TracksOfImagesThatWereFilteredOutAreOneNote) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddPoint({0, 0, 5}, {0, 7});
  files.AddPoint({0, 0, 5}, {0, 8});
  files.Open();
  EXPECT_THAT(files.Warnings(), IsEmpty());
  EXPECT_THAT(files.Notes(),
              ElementsAre(testing::AllOf(HasSubstr("2 of 4 observations"),
                                         HasSubstr("id 17"))));
  files.AddPoint({0, 0, 5}, {8});  // now most of them
  files.Open();
  EXPECT_THAT(files.Warnings(), ElementsAre(HasSubstr("one model")));
}

TEST(Workspace, AFolderThatIsNoWorkspaceIsNamed) {
  const ScratchFolder folder;
  WorkspaceOptions options;
  options.path = folder / "nowhere";
  auto error = ErrorOf([&] { Workspace(options, nullptr); });
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr("no folder"));
  std::filesystem::create_directories(folder / "dense/sparse");
  options.path = folder.path();
  error = ErrorOf([&] { Workspace(options, nullptr); });
  ASSERT_TRUE(error);
  EXPECT_THAT(error->what(), HasSubstr((folder / "dense").string() + " has"));
}

TEST(Workspace, WithoutAnyUsableImageIsAnError) {
  TestWorkspace files;
  files.AddCamera(2, "SIMPLE_RADIAL 160 120 100 80 60 0.1");
  files.AddImage("a.jpg", {0, 0, 0}, 2);
  const auto error = ErrorOf([&] { files.Open(); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr("image_undistorter"));
}

TEST(Workspace, RefusesNamesThatLeaveItsFolders) {
  for (const char* name : {"../a.jpg", "/etc/a.jpg", "x/../../a.jpg"}) {
    TestWorkspace files;
    files.AddImage(name, {0, 0, 0});
    const auto error = ErrorOf([&] { files.Open(); });
    ASSERT_TRUE(error) << name;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), HasSubstr(name));
  }
}

TEST(Workspace, RefusesTwoImagesOfOneName) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.AddImage("a.jpg", {1, 0, 0});
  const auto error = ErrorOf([&] { files.Open(); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr("a.jpg"));
}

TEST(Workspace, FormatNameIgnoresCaseAndOthersAreUsageErrors) {
  TestWorkspace files;
  files.AddImage("a.jpg", {0, 0, 0});
  files.Open();
  WorkspaceOptions options;
  options.path = files.path();
  options.format = "colMAP";
  EXPECT_EQ(Workspace(options, nullptr).num_images(), 1);
  options.format = "COLMAPS";
  const auto error = ErrorOf([&] { Workspace(options, nullptr); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kUsage);
}

TEST(Workspace, PmvsFolderGetsItsStereoFolderAndCfgFiles) {
  const ScratchFolder folder;
  const std::string identity = "1 0 0\n0 1 0\n0 0 1\n0 0 0\n";
  WriteFile(folder.path() / "bundle.rd.out",
            "# Bundle file v0.3\n2 1\n100 0 0\n" + identity + "110 0 0\n" +
                identity + "0 0 -5\n1 2 3\n2 0 0 0 0 1 0 0 0\n");
  WriteFile(folder.path() / "visualize/00000000.jpg", PngHeader(160, 120));
  WriteFile(folder.path() / "visualize/00000001.jpg", PngHeader(80, 60));
  WriteFile(folder.path() / "my-option", "level 1\ntimages -1 0 2\n");
  WorkspaceOptions options;
  options.path = folder.path();
  options.format = "pmvs";
  options.pmvs_option_name = "my-option";
  const Workspace workspace(options, nullptr);
  ASSERT_EQ(workspace.num_images(), 2);
  EXPECT_EQ(workspace.StereoPath(), folder.path() / "stereo-my-option");
  EXPECT_EQ(workspace.ImagePath(1), folder.path() / "visualize/00000001.jpg");
  EXPECT_EQ(workspace.camera(0).fx, 100);
  EXPECT_EQ(workspace.camera(0).cx, 79.5f);
  EXPECT_EQ(workspace.camera(1).cy, 29.5f);
  EXPECT_EQ(ReadFile(workspace.FusionCfgPath()),
            "00000000.jpg\n00000001.jpg\n");
  const auto entries = ReadPatchMatchCfg(workspace.PatchMatchCfgPath()).entries;
  ASSERT_EQ(entries.size(), 2u);
  EXPECT_EQ(entries[1].ref_name, "00000001.jpg");
  EXPECT_EQ(entries[1].max_num_auto, 20);
}

TEST(Workspace, PmvsImageWithoutASizeIsNamed) {
  const ScratchFolder folder;
  WriteFile(folder.path() / "bundle.rd.out",
            "# Bundle file v0.3\n1 0\n100 0 0\n1 0 0\n0 1 0\n0 0 1\n0 0 0\n");
  WriteFile(folder.path() / "option-all", "timages -1 0 1\n");
  WorkspaceOptions options;
  options.path = folder.path();
  options.format = "PMVS";
  const auto error = ErrorOf([&] { Workspace(options, nullptr); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr("00000000.jpg"));
}

}  // namespace
}  // namespace hpm
