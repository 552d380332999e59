// System calls are replaced by ones that record their order and fail on demand:
// a symbol of the program wins over the one of the C library.
#include "colmap_plugin/formats/atomic_file.h"
#include "colmap_plugin/formats/map_file.h"
#include "src/base/retries.h"
#include "tests/colmap_plugin/formats/test_files.h"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <optional>
#include <vector>

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

struct Faults {
  bool recording = false;
  std::vector<std::string> calls;
  int write_error = 0;
  int fsync_error = 0;
  int close_error = 0;
  int rename_error = 0;
  int stat_error = 0;
  int num_interrupts = 0;       // writes and syncs that fail with EINTR first
  int num_failures = INT_MAX;   // after so many every call succeeds
  size_t max_write = SIZE_MAX;  // short writes
};
Faults faults;

// Returns true if the call has to fail; errno is set then.
bool Intercept(const char* call, int error) {
  if (!faults.recording) return false;
  faults.calls.push_back(call);
  if (error == 0 || faults.num_failures == 0) return false;
  --faults.num_failures;
  errno = error;
  return true;
}

bool Interrupt() {
  if (!faults.recording || faults.num_interrupts == 0) return false;
  --faults.num_interrupts;
  errno = EINTR;
  return true;
}

}  // namespace

extern "C" {

ssize_t write(int fd, const void* data, size_t num_bytes) {
  if (faults.recording && Interrupt()) return -1;
  if (Intercept("write", faults.write_error)) return -1;
  if (faults.recording) num_bytes = std::min(num_bytes, faults.max_write);
  return syscall(SYS_write, fd, data, num_bytes);
}

int fsync(int fd) {
  if (Interrupt()) return -1;
  if (Intercept("fsync", faults.fsync_error)) return -1;
  return static_cast<int>(syscall(SYS_fsync, fd));
}

int close(int fd) {
  const int result = static_cast<int>(syscall(SYS_close, fd));
  return Intercept("close", faults.close_error) ? -1 : result;
}

int rename(const char* from, const char* to) noexcept {
  if (Intercept("rename", faults.rename_error)) return -1;
  return static_cast<int>(
      syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int stat(const char* path, struct stat* status) noexcept {
  if (faults.stat_error != 0 && Intercept("stat", faults.stat_error)) return -1;
  return static_cast<int>(syscall(SYS_newfstatat, AT_FDCWD, path, status, 0));
}

}  // extern "C"

namespace hpm {
namespace {

RetryRules Quick() { return {3, std::chrono::milliseconds(1), 1}; }

// Writes path with the faults that `prepare` sets; returns the error, if any.
template <class Prepare>
std::optional<Error> WriteWithFaults(const std::filesystem::path& path,
                                     Prepare prepare) {
  faults = Faults();
  prepare();
  std::optional<Error> result;
  faults.recording = true;
  try {
    WriteFileAtomically(path, "0123456789");
  } catch (const Error& error) {
    result = error;
  }
  faults.recording = false;
  return result;
}

TEST(AtomicFile, SyncsTheFileBeforeRenamingAndTheFolderAfter) {
  const ScratchFolder folder;
  EXPECT_FALSE(WriteWithFaults(folder / "f", [] {}));
  EXPECT_THAT(faults.calls,
              testing::ElementsAre(
                  "write", "fsync", "close", "rename", "fsync", "close"));
  EXPECT_EQ(ReadFile(folder / "f"), "0123456789");
}

TEST(AtomicFile, WhatWasFlushedIsNotSyncedAgain) {
  const ScratchFolder folder;
  faults = Faults();
  faults.recording = true;
  {
    AtomicFile file(folder / "f");
    file.Write("0123");
    file.Flush();
    file.Write("4567");
    file.Flush();
    file.Commit();
  }
  faults.recording = false;
  EXPECT_THAT(faults.calls,
              testing::ElementsAre("write",
                                   "fsync",
                                   "write",
                                   "fsync",
                                   "close",
                                   "rename",
                                   "fsync",
                                   "close"));
}

TEST(AtomicFile, TheFolderIsOpenedAnewForEachTry) {
  const ScratchFolder folder;
  const RetryScope scope(nullptr, nullptr, Quick());
  faults = Faults();
  faults.recording = true;
  {
    AtomicFile file(folder / "f");
    file.Write("0123");
    file.Flush();
    faults.fsync_error = ESTALE;
    faults.num_failures = 1;
    file.Commit();
  }
  faults.recording = false;
  EXPECT_THAT(faults.calls,
              testing::ElementsAre("write",
                                   "fsync",
                                   "close",
                                   "rename",
                                   "fsync",
                                   "close",
                                   "fsync",
                                   "close"));
}

TEST(AtomicFile, WhatNeedsNoSyncIsRenamedAllTheSame) {
  const ScratchFolder folder;
  faults = Faults();
  faults.recording = true;
  WriteFileAtomically(folder / "f", "0123456789", Durability::kProcess);
  faults.recording = false;
  EXPECT_THAT(faults.calls, testing::ElementsAre("write", "close", "rename"));
  EXPECT_EQ(ReadFile(folder / "f"), "0123456789");
}

TEST(AtomicFile, SurvivesInterruptsAndShortWrites) {
  const ScratchFolder folder;
  EXPECT_FALSE(WriteWithFaults(folder / "f", [] {
    faults.num_interrupts = 3;
    faults.max_write = 3;
  }));
  EXPECT_EQ(ReadFile(folder / "f"), "0123456789");
}

constexpr int Faults::*kSteps[] = {&Faults::write_error,
                                   &Faults::fsync_error,
                                   &Faults::close_error,
                                   &Faults::rename_error};

TEST(AtomicFile, ErrorsThatPassAreRetriedAndTold) {
  const ScratchFolder folder;
  for (int Faults::*step : kSteps) {
    for (const int error : {EIO, ESTALE, EAGAIN}) {
      std::vector<std::string> log;
      const RetryScope scope(
          [&log](LogLevel, const std::string& line) { log.push_back(line); },
          nullptr,
          Quick());
      std::filesystem::remove(folder / "f");
      EXPECT_FALSE(WriteWithFaults(folder / "f", [step, error] {
        faults.*step = error;
        faults.num_failures = 3;
      }));
      EXPECT_EQ(ReadFile(folder / "f"), "0123456789");
      EXPECT_EQ(folder.CountFiles(), 1u);
      ASSERT_FALSE(log.empty());
      EXPECT_THAT(log[0], testing::HasSubstr((folder / "f").string()));
      EXPECT_THAT(log[0], testing::HasSubstr("trying again"));
    }
  }
}

// fsync(2): after EIO the kernel may have dropped what was written, and a
// second fsync says nothing of it.
TEST(AtomicFile, AfterAnErrorOfTheDiskAllIsWrittenAnew) {
  const ScratchFolder folder;
  const RetryScope scope(nullptr, nullptr, Quick());
  EXPECT_FALSE(WriteWithFaults(folder / "f", [] {
    faults.fsync_error = EIO;
    faults.num_failures = 1;
  }));
  EXPECT_THAT(faults.calls,
              testing::ElementsAre("write",
                                   "fsync",
                                   "close",
                                   "write",
                                   "fsync",
                                   "close",
                                   "rename",
                                   "fsync",
                                   "close"));
}

TEST(AtomicFile, MapsAreWrittenAnewAsAWhole) {
  const ScratchFolder folder;
  const RetryScope scope(nullptr, nullptr, Quick());
  const Map map = {2, 1, 1, {1, 2}};
  faults = Faults();
  faults.fsync_error = EIO;
  faults.num_failures = 2;
  faults.recording = true;
  WriteMap(folder / "m", map);
  faults.recording = false;
  EXPECT_EQ(ReadMap(folder / "m").data, map.data);
}

TEST(AtomicFile, ErrorsThatStayEndTheTries) {
  const ScratchFolder folder;
  WriteFileAtomically(folder / "f", "old");
  const RetryScope scope(nullptr, nullptr, Quick());
  for (int Faults::*step : kSteps) {
    const auto error =
        WriteWithFaults(folder / "f", [step] { faults.*step = EIO; });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kFailure);
    EXPECT_THAT(error->what(), testing::HasSubstr((folder / "f").string()));
    EXPECT_EQ(faults.num_failures, INT_MAX - 4);
    EXPECT_EQ(ReadFile(folder / "f"), "old");
    EXPECT_EQ(folder.CountFiles(), 1u);
  }
}

TEST(StateOf, AFileWhoseDiskDoesNotAnswerIsNotAbsent) {
  const ScratchFolder folder;
  WriteFile(folder / "f", "1");
  const RetryScope scope(nullptr, nullptr, Quick());
  faults = Faults();
  faults.stat_error = EIO;
  faults.recording = true;
  ExpectError(ErrorCode::kBadInput, "f", [&] { StateOf(folder / "f"); });
  ExpectError(ErrorCode::kBadInput, "f", [&] { IsRegularFile(folder / "f"); });
  faults.stat_error = ENOENT;
  EXPECT_FALSE(StateOf(folder / "f"));
  EXPECT_FALSE(IsRegularFile(folder / "f"));
  faults.recording = false;
}

TEST(AtomicFile, AnInterruptEndsTheTries) {
  const ScratchFolder folder;
  CancelToken cancel;
  cancel.Cancel();
  const RetryScope scope(
      nullptr, &cancel, {3, std::chrono::milliseconds(100000), 1});
  const auto error =
      WriteWithFaults(folder / "f", [] { faults.write_error = EIO; });
  ASSERT_TRUE(error);
  EXPECT_EQ(error->code(), ErrorCode::kInterrupted);
  EXPECT_EQ(folder.CountFiles(), 0u);
}

TEST(AtomicFile, AnyFailedStepLeavesTheOldFileAndNoTemporary) {
  const ScratchFolder folder;
  WriteFileAtomically(folder / "f", "old");
  for (int Faults::*step : kSteps) {
    const auto error =
        WriteWithFaults(folder / "f", [step] { faults.*step = ENOSPC; });
    ASSERT_TRUE(error);
    EXPECT_EQ(error->code(), ErrorCode::kOutOfResources);
    EXPECT_THAT(error->what(), testing::HasSubstr((folder / "f").string()));
    EXPECT_THAT(error->what(), testing::HasSubstr("bytes free"));
    EXPECT_EQ(ReadFile(folder / "f"), "old");
    EXPECT_EQ(folder.CountFiles(), 1u);
  }
}

TEST(AtomicFile, ErrorsAreSortedByWhoCanMendThem) {
  const ScratchFolder folder;
  const RetryScope scope(nullptr, nullptr, Quick());
  const auto code_of = [&](int error) {
    return WriteWithFaults(folder / "f",
                           [error] { faults.write_error = error; })
        ->code();
  };
  for (const int error : {ENOSPC, EDQUOT, EFBIG}) {
    EXPECT_EQ(code_of(error), ErrorCode::kOutOfResources) << error;
  }
  for (const int error : {EACCES, EROFS, ENOENT}) {
    EXPECT_EQ(code_of(error), ErrorCode::kBadInput) << error;
  }
  EXPECT_EQ(code_of(EIO), ErrorCode::kFailure);
}

}  // namespace
}  // namespace hpm
