#include "colmap_plugin/workspace/output_check.h"

#include "colmap_plugin/formats/map_file.h"
#include "colmap_plugin/workspace/run_record.h"
#include "tests/colmap_plugin/workspace/test_workspace.h"

#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

namespace hpm {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class OutputCheckTest : public ::testing::Test {
 protected:
  OutputCheckTest() {
    files_.AddImage("a.jpg", {0, 0, 0});
    files_.AddImage("cam1/day2/x.jpg", {1, 0, 0});
    problems_ = {{1, {0}, 1, 2}, {0, {1}, 1, 2}};
  }
  TestWorkspace files_;
  std::vector<StereoProblem> problems_;
};

TEST_F(OutputCheckTest, CreatesEveryFolderAndLeavesNoTrialFile) {
  const Workspace workspace = files_.Open();
  PrepareOutputs(workspace, problems_, 0, files_.Log());
  for (const char* kind : {"depth_maps", "normal_maps", "consistency_graphs"}) {
    EXPECT_TRUE(fs::is_directory(workspace.StereoPath() / kind / "cam1/day2"));
  }
  EXPECT_TRUE(fs::is_directory(workspace.StatePath()));
  std::vector<std::string> left;
  for (const auto& entry :
       fs::recursive_directory_iterator(workspace.StereoPath())) {
    if (!entry.is_directory()) left.push_back(entry.path().filename().string());
  }
  EXPECT_THAT(left, testing::ElementsAre("fusion.cfg"));
}

TEST_F(OutputCheckTest, InspectsWithoutMakingAnything) {
  const Workspace workspace = files_.Open();
  WriteFile(workspace.StereoPath() / "a file", "");
  const auto inspect = [&](uint64_t num_bytes) {
    return ErrorOf([&] {
      CheckOutputs(workspace, problems_, num_bytes, OutputAccess::kInspect);
    });
  };
  EXPECT_FALSE(inspect(0));
  const auto full = inspect(uint64_t{1} << 62);
  ASSERT_TRUE(full);
  EXPECT_EQ(full->code(), ErrorCode::kOutOfResources);
  const auto entries = [&] {
    return std::distance(fs::recursive_directory_iterator(files_.path()),
                         fs::recursive_directory_iterator());
  };
  const auto before = entries();
  WriteFile(workspace.StereoPath() / "normal_maps", "a file");
  const auto error = inspect(0);
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr("normal_maps"));
  EXPECT_EQ(entries(), before + 1);
}

TEST_F(OutputCheckTest, WritesFusionCfgOnlyIfThereIsNone) {
  const Workspace workspace = files_.Open();
  PrepareOutputs(workspace, problems_, 0, files_.Log());
  EXPECT_EQ(ReadFile(workspace.FusionCfgPath()), "cam1/day2/x.jpg\na.jpg\n");
  WriteFile(workspace.FusionCfgPath(), "a.jpg\n");
  PrepareOutputs(workspace, problems_, 0, files_.Log());
  EXPECT_EQ(ReadFile(workspace.FusionCfgPath()), "a.jpg\n");
}

TEST_F(OutputCheckTest, TooSmallADiskIsToldWithNeededAndFreeBytes) {
  const Workspace workspace = files_.Open();
  const uint64_t needed = uint64_t{1} << 62;
  const auto error = ErrorOf(
      [&] { PrepareOutputs(workspace, problems_, needed, files_.Log()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kOutOfResources);
  EXPECT_THAT(error->what(), HasSubstr(std::to_string(needed)));
  EXPECT_THAT(error->what(), HasSubstr("bytes are free"));
}

TEST_F(OutputCheckTest, AFileInPlaceOfAFolderIsNamed) {
  const Workspace workspace = files_.Open();
  WriteFile(workspace.StereoPath() / "normal_maps", "a file");
  const auto error =
      ErrorOf([&] { PrepareOutputs(workspace, problems_, 0, files_.Log()); });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kBadInput);
  EXPECT_THAT(error->what(), HasSubstr("normal_maps"));
}

TEST_F(OutputCheckTest, NamesTooLongForTheirMapsAreToldBeforehand) {
  for (const size_t length : {239, 240}) {
    TestWorkspace files;
    files.AddImage(std::string(length, 'a'), {0, 0, 0});
    files.AddImage("b.jpg", {1, 0, 0});
    const Workspace workspace = files.Open();
    const auto error =
        ErrorOf([&] { PrepareOutputs(workspace, problems_, 0, files.Log()); });
    ASSERT_EQ(error.has_value(), length == 240);
    // No folder for maps is there yet.
    TestWorkspace fresh;
    fresh.AddImage(std::string(length, 'a'), {0, 0, 0});
    fresh.AddImage("b.jpg", {1, 0, 0});
    EXPECT_EQ(ErrorOf([&] {
                CheckOutputs(
                    fresh.Open(), problems_, 0, OutputAccess::kInspect);
              }).has_value(),
              length == 240);
    if (!error) continue;
    EXPECT_EQ(error->code(), ErrorCode::kBadInput);
    EXPECT_THAT(error->what(), HasSubstr("'aaa"));
    EXPECT_THAT(error->what(), HasSubstr("256 bytes"));
  }
}

TEST_F(OutputCheckTest, AFusionCfgOfNoUseIsToldOnce) {
  struct Case {
    const char* text;
    std::vector<const char*> words;  // none: no warning
  };
  for (const Case& c : {Case{"a.jpg\n\n", {}},
                        Case{"a.jpg\nold1.jpg\ncam1\\day2\\x.jpg\n",
                             {"2 images", "line 2, 'old1.jpg'", "delete it"}},
                        Case{"\n", {"no image", "delete it"}}}) {
    TestWorkspace files;
    files.AddImage("a.jpg", {0, 0, 0});
    files.AddImage("cam1/day2/x.jpg", {1, 0, 0});
    const Workspace workspace = files.Open();
    WriteFile(workspace.FusionCfgPath(), c.text);
    PrepareOutputs(workspace, problems_, 0, files.Log());
    EXPECT_EQ(ReadFile(workspace.FusionCfgPath()), c.text);
    ASSERT_EQ(files.Warnings().size(), c.words.empty() ? 0u : 1u) << c.text;
    for (const char* word : c.words)
      EXPECT_THAT(files.Warnings()[0], HasSubstr(word));
  }
}

// In a child, since permission bits mean nothing to root.
TEST_F(OutputCheckTest, AFolderWithoutPermissionIsNamed) {
  const Workspace workspace = files_.Open();
  PrepareOutputs(workspace, problems_, 0, files_.Log());
  const fs::path folder = workspace.StereoPath() / "depth_maps";
  fs::permissions(files_.path(), fs::perms::all);
  for (const auto& entry : fs::recursive_directory_iterator(files_.path())) {
    fs::permissions(entry.path(), fs::perms::all);
  }
  ASSERT_EQ(chmod(folder.c_str(), 0555), 0);
  const pid_t pid = fork();
  if (pid == 0) {
    if (geteuid() == 0 && setuid(65534) != 0) _exit(100);
    const auto error =
        ErrorOf([&] { PrepareOutputs(workspace, problems_, 0, files_.Log()); });
    if (!error) _exit(101);
    const bool named =
        std::string(error->what()).find("depth_maps") != std::string::npos;
    _exit(named ? static_cast<int>(error->code()) : 102);
  }
  int status = 0;
  ASSERT_EQ(waitpid(pid, &status, 0), pid);
  chmod(folder.c_str(), 0755);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 100)
    GTEST_SKIP() << "cannot become an unprivileged user";
  EXPECT_EQ(WEXITSTATUS(status), static_cast<int>(ErrorCode::kBadInput));
}

TEST_F(OutputCheckTest, MapBytesAreTheSizesOfTheFiles) {
  const Camera camera = files_.Open().camera(0);
  uint64_t num_bytes = 0;
  for (const int channels : {1, 3}) {
    const size_t num_values =
        static_cast<size_t>(camera.width) * camera.height * channels;
    const fs::path path = files_.path() / "map.bin";
    WriteMap(path,
             {camera.width,
              camera.height,
              channels,
              std::vector<float>(num_values, 1)});
    num_bytes += fs::file_size(path);
  }
  EXPECT_EQ(DepthAndNormalMapBytes(camera), num_bytes);
}

TEST(RunRecord, IsReadableJson) {
  const ScratchFolder state;
  WriteRunRecord(state.path(), "run.json", {{"images", 3}, {"name", "\xff"}});
  EXPECT_EQ(
      nlohmann::json::parse(ReadFile(state.path() / "run.json"))["images"], 3);
}

}  // namespace
}  // namespace hpm
