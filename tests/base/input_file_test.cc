// System calls are replaced by ones that fail on demand: a symbol of the
// program wins over the one of the C library.
#include "src/base/input_file.h"

#include "src/base/error.h"
#include "src/base/retries.h"
#include "tests/base/scratch_folder.h"

#include <algorithm>
#include <cerrno>
#include <cstdarg>
#include <string>
#include <vector>

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace {

struct Faults {
  int error = 0;
  int num_opens = 0;  // that fail
  int num_reads = 0;
  int stale_fd = -1;  // no read of it succeeds any more
  int num_stale_reads = 0;
  size_t max_read = SIZE_MAX;
};
Faults faults;

bool Fails(int* count) {
  if (*count == 0) return false;
  --*count;
  errno = faults.error;
  return true;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  mode_t mode = 0;
  if ((flags & O_CREAT) != 0) {
    va_list arguments;
    va_start(arguments, flags);
    mode = va_arg(arguments, mode_t);
    va_end(arguments);
  }
  if (Fails(&faults.num_opens)) return -1;
  const int fd =
      static_cast<int>(syscall(SYS_openat, AT_FDCWD, path, flags, mode));
  if (fd == faults.stale_fd) faults.stale_fd = -1;
  return fd;
}

int dup2(int from, int to) noexcept {
  if (to == faults.stale_fd) faults.stale_fd = -1;
  return static_cast<int>(syscall(SYS_dup3, from, to, 0));
}

ssize_t pread(int fd, void* data, size_t num_bytes, off_t offset) {
  if (faults.num_reads > 0 && faults.error == ESTALE) faults.stale_fd = fd;
  if (Fails(&faults.num_reads)) return -1;
  if (fd == faults.stale_fd) {
    ++faults.num_stale_reads;
    errno = ESTALE;
    return -1;
  }
  return syscall(
      SYS_pread64, fd, data, std::min(num_bytes, faults.max_read), offset);
}

}  // extern "C"

namespace hpm {
namespace {

class InputFileTest : public testing::Test {
 protected:
  void SetUp() override { WriteFile(folder_ / "f", "0123456789"); }
  void TearDown() override { faults = Faults(); }

  std::string Read() { return ReadWholeFile(folder_ / "f", 100); }

  const ScratchFolder folder_;
};

RetryRules Quick() { return {3, std::chrono::milliseconds(1), 1}; }

TEST_F(InputFileTest, ErrorsThatPassAreRetriedAndTold) {
  for (const int error : {EIO, ESTALE, EAGAIN}) {
    for (int Faults::*call : {&Faults::num_opens, &Faults::num_reads}) {
      std::vector<std::string> log;
      const RetryScope scope(
          [&log](LogLevel, const std::string& line) { log.push_back(line); },
          nullptr,
          Quick());
      faults = Faults();
      faults.error = error;
      faults.*call = 2;
      EXPECT_EQ(Read(), "0123456789") << error;
      ASSERT_FALSE(log.empty());
      EXPECT_THAT(log[0], testing::HasSubstr((folder_ / "f").string()));
    }
  }
}

TEST_F(InputFileTest, InterruptsAndShortReadsAreNoErrors) {
  const RetryScope scope(
      [](LogLevel, const std::string& line) { ADD_FAILURE() << line; },
      nullptr,
      Quick());
  faults.error = EINTR;
  faults.num_opens = 5;
  faults.num_reads = 5;
  faults.max_read = 3;
  EXPECT_EQ(Read(), "0123456789");
}

TEST_F(InputFileTest, ErrorsThatStayEndTheTries) {
  const RetryScope scope(nullptr, nullptr, Quick());
  for (int Faults::*call : {&Faults::num_opens, &Faults::num_reads}) {
    faults = Faults();
    faults.error = EIO;
    faults.*call = 1000;
    try {
      Read();
      ADD_FAILURE() << "no error";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::kBadInput);
      EXPECT_THAT(error.what(), testing::HasSubstr((folder_ / "f").string()));
    }
    EXPECT_EQ(faults.*call, 1000 - 4);
  }
}

TEST_F(InputFileTest, AStaleHandleIsReplacedOnce) {
  const RetryScope scope(nullptr, nullptr, Quick());
  const InputFile file(folder_ / "f");
  faults.error = ESTALE;
  faults.num_reads = 1;
  char byte = 0;
  for (const char expected : {'0', '1', '2'}) {
    EXPECT_EQ(file.ReadAt(expected - '0', &byte, 1), 1u);
    EXPECT_EQ(byte, expected);
  }
  EXPECT_EQ(faults.num_stale_reads, 0);
}

TEST_F(InputFileTest, AnotherFileUnderTheNameIsNotReadOnWith) {
  const RetryScope scope(nullptr, nullptr, Quick());
  for (const char* other : {"longer than before", "same longs"}) {
    WriteFile(folder_ / "f", "0123456789");
    const InputFile file(folder_ / "f");
    WriteFile(folder_ / "f", other);
    std::filesystem::last_write_time(
        folder_ / "f",
        std::filesystem::last_write_time(folder_ / "f") +
            std::chrono::seconds(1));
    faults.error = ESTALE;
    faults.num_reads = 1;
    char byte;
    EXPECT_THROW(file.ReadAt(0, &byte, 1), Error) << other;
  }
}

TEST_F(InputFileTest, TooLargeAFileIsRefusedUnread) {
  faults.error = EIO;
  faults.num_reads = 1000;
  EXPECT_THROW(ReadWholeFile(folder_ / "f", 9), Error);
  EXPECT_EQ(faults.num_reads, 1000);
}

}  // namespace
}  // namespace hpm
