#include "colmap_plugin/formats/content_hash.h"

#include "colmap_plugin/formats/published_file.h"
#include "tests/colmap_plugin/formats/test_files.h"

#include <algorithm>
#include <chrono>

namespace hpm {
namespace {

std::string HashOf(const std::string& text) {
  return ContentHash().Add(text.data(), text.size()).Hex();
}

// Of a length that no buffer divides.
std::string ManyBytes() {
  std::string bytes;
  for (int i = 0; i < 1000003; ++i) bytes += static_cast<char>(i * 7 + i / 256);
  return bytes;
}

// Stamps are compared across machines.
TEST(ContentHash, IsThatOfXxhsum) {
  EXPECT_EQ(HashOf(""), "99aa06d3014798d86001c324468d497f");
}

TEST(ContentHash, DoesNotDependOnThePieces) {
  const std::string bytes = ManyBytes();
  ContentHash hash;
  for (size_t at = 0, step = 1; at < bytes.size(); at += step, step = 3 * step)
    hash.Add(&bytes[at], std::min(step, bytes.size() - at));
  EXPECT_EQ(hash.Hex(), HashOf(bytes));
}

TEST(ContentHash, OfAFileIsThatOfItsBytes) {
  const ScratchFolder folder;
  for (const std::string& bytes : {std::string(), ManyBytes()}) {
    WriteFile(folder / "f", bytes);
    EXPECT_EQ(HashFile(folder / "f", CancelToken()), HashOf(bytes));
  }
}

TEST(ContentHash, OfAFileThatCannotBeReadNamesIt) {
  const ScratchFolder folder;
  for (const auto& path : {folder / "missing", folder.path()}) {
    ExpectError(ErrorCode::kBadInput, path.string(), [&] {
      HashFile(path, CancelToken());
    });
  }
}

TEST(ContentHash, OfAFileCanBeInterrupted) {
  const ScratchFolder folder;
  WriteFile(folder / "f", "text");
  CancelToken cancel;
  cancel.Cancel();
  ExpectError(
      ErrorCode::kInterrupted, "", [&] { HashFile(folder / "f", cancel); });
}

TEST(FileState, TellsEveryNanosecond) {
  const ScratchFolder folder;
  EXPECT_FALSE(StateOf(folder / "f"));
  WriteFile(folder / "f", "text");
  const std::optional<FileState> before = StateOf(folder / "f");
  ASSERT_TRUE(before);
  EXPECT_EQ(before->num_bytes, 4u);
  std::filesystem::last_write_time(
      folder / "f",
      std::filesystem::last_write_time(folder / "f") +
          std::chrono::nanoseconds(1));
  EXPECT_EQ(StateOf(folder / "f")->time_ns, before->time_ns + 1);
}

}  // namespace
}  // namespace hpm
