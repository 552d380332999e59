#include "colmap_plugin/formats/atomic_file.h"

#include "tests/colmap_plugin/formats/test_files.h"

#include <filesystem>
#include <string>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

namespace hpm {
namespace {

TEST(AtomicFile, NothingAppearsWithoutCommit) {
  const ScratchFolder folder;
  {
    AtomicFile file(folder / "f");
    file.Write("half");
    EXPECT_EQ(folder.CountFiles(), 1u);
    EXPECT_FALSE(std::filesystem::exists(folder / "f"));
  }
  EXPECT_EQ(folder.CountFiles(), 0u);
}

TEST(AtomicFile, AFileInPlaceOfTheFolderIsBadInput) {
  const ScratchFolder folder;
  WriteFile(folder / "file", "x");
  ExpectError(ErrorCode::kBadInput, "f", [&] {
    WriteFileAtomically(folder / "file/sub/f", "y");
  });
}

TEST(AtomicFile, NeverFollowsALinkInPlaceOfTheTemporary) {
  const ScratchFolder folder;
  WriteFile(folder / "canary", "alive");
  std::filesystem::path temporary;
  {
    const AtomicFile file(folder / "f");
    for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
      if (entry.path().filename() != "canary") temporary = entry.path();
  }
  ASSERT_FALSE(std::filesystem::exists(temporary));
  std::filesystem::create_symlink(folder / "canary", temporary);
  WriteFileAtomically(folder / "f", "new");
  EXPECT_EQ(ReadFile(folder / "canary"), "alive");
  EXPECT_EQ(ReadFile(folder / "f"), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "f"));
}

TEST(AtomicFile, WritesFilesWithNamesAsLongAsTheDiskAllows) {
  const ScratchFolder folder;
  const std::string a(255, 'a');
  const std::string b = std::string(254, 'a') + "b";
  AtomicFile first(folder / a);
  AtomicFile second(folder / b);  // the two do not get into each other's way
  first.Write("1");
  second.Write("2");
  first.Commit();
  second.Commit();
  EXPECT_EQ(ReadFile(folder / a), "1");
  EXPECT_EQ(ReadFile(folder / b), "2");
  ExpectError(ErrorCode::kBadInput, "aaa", [&] {
    WriteFileAtomically(folder / (a + "a"), "y");
  });
}

TEST(AtomicFile, ALinkUnderTheFinalNameIsReplacedNotFollowed) {
  const ScratchFolder folder;
  WriteFile(folder / "canary", "alive");
  std::filesystem::create_symlink(folder / "canary", folder / "f");
  WriteFileAtomically(folder / "f", "new");
  EXPECT_EQ(ReadFile(folder / "canary"), "alive");
  EXPECT_EQ(ReadFile(folder / "f"), "new");
}

std::string ThisHost() {
  char host[256] = {};
  gethostname(host, sizeof(host) - 1);
  return host;
}

std::string OwnersName() {
  const ScratchFolder folder;
  const AtomicFile file(folder / "f");
  const std::string name =
      std::filesystem::directory_iterator(folder.path())->path().filename();
  const size_t begin = name.find(".tmp.") + 5;
  return name.substr(begin, name.rfind('.') - begin);
}

TEST(RemoveStaleTemporaries, RemovesOnlyThoseOfDeadProcessesOfThisHost) {
  const ScratchFolder folder;
  const pid_t child = fork();
  if (child == 0) _exit(0);
  ASSERT_GT(child, 0);
  ASSERT_EQ(waitpid(child, nullptr, 0), child);
  const std::string dead = std::to_string(child);
  // As this process's temporaries have it between ".tmp." and its id.
  const std::string host = OwnersName();
  const std::string stale = "sub/a.bin.tmp." + host + "." + dead;
  const std::vector<std::string> kept = {
      "a.bin",
      "a.bin.tmp." + host + "." + std::to_string(getpid()),
      "a.bin.tmp.other-" + host + "." + dead,
      // Of another machine or container with the same name.
      "a.bin.tmp." + ThisHost() + ".00000000." + dead,
      "a.bin.tmp." + ThisHost() + "." + dead,
      "a.bin.tmp." + host + "." + dead + "x",
      "a.bin.tmp." + host + ".",
      "a.bin.tmp." + host + ".-" + dead,
      "a.bin.tmp." + host + ".99999999999999999999",
      "a.bin." + dead,
      dead};
  WriteFile(folder / stale, "torn");
  for (const std::string& name : kept) WriteFile(folder / name, "keep");
  std::filesystem::create_symlink(folder / "a.bin",
                                  folder / ("l.bin.tmp." + host + "." + dead));

  RemoveStaleTemporaries(folder.path());
  EXPECT_FALSE(std::filesystem::exists(folder / stale));
  EXPECT_EQ(folder.CountFiles(), kept.size() + 1);
  RemoveStaleTemporaries(folder / "none");
}

}  // namespace
}  // namespace hpm
