#include "src/base/platform/files.h"

#include "src/base/platform/errors.h"
#include "tests/base/scratch_folder.h"

#include <cerrno>
#include <chrono>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>

namespace hpm {
namespace {

constexpr int kCreate = O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC;

class Files : public testing::Test {
 protected:
  int Create(const char* name) {
    return open((folder_ / name).c_str(), kCreate, 0666);
  }
  ScratchFolder folder_;
};

TEST_F(Files, AreWrittenAndReadAtPlaces) {
  const int fd = Create("a");
  ASSERT_GE(fd, 0);
  EXPECT_EQ(write(fd, "one\n", 4), 4);
  EXPECT_EQ(pwrite(fd, "two\r\n", 5, 10), 5);
  EXPECT_EQ(write(fd, "!", 1), 1);  // goes on where it was
  char bytes[32] = {};
  EXPECT_EQ(pread(fd, bytes, sizeof(bytes), 8), 7);
  EXPECT_EQ(std::string(bytes + 2, 5), "two\r\n");
  EXPECT_EQ(pread(fd, bytes, sizeof(bytes), 15), 0);
  EXPECT_EQ(pread(fd, bytes, 5, 0), 5);
  EXPECT_EQ(std::string(bytes, 5), "one\n!");
  EXPECT_EQ(SyncFile(fd), 0);
  EXPECT_EQ(close(fd), 0);
  EXPECT_EQ(ReadFile(folder_ / "a").size(), 15u);
}

TEST_F(Files, ADescriptorTakesThePlaceOfAnother) {
  WriteFile(folder_ / "a", "a");
  WriteFile(folder_ / "b", "b");
  const int a = open((folder_ / "a").c_str(), O_RDONLY);
  const int b = open((folder_ / "b").c_str(), O_RDONLY);
  ASSERT_EQ(MoveDescriptor(b, a), 0);
  char byte = 0;
  EXPECT_EQ(pread(a, &byte, 1, 0), 1);
  EXPECT_EQ(byte, 'b');
  EXPECT_EQ(pread(b, &byte, 1, 0), -1);
  close(a);
}

// As std::filesystem says it: on Windows in numbers of its own, of which the 5
// of a missing permission would be EIO.
TEST_F(Files, ErrorsHaveTheNumbersOfErrno) {
  std::error_code error;
  EXPECT_FALSE(
      std::filesystem::create_directory(folder_ / "none" / "a", error));
  EXPECT_EQ(ErrnoOf(error), ENOENT);
  EXPECT_EQ(ErrnoOf(std::error_code()), 0);
}

TEST_F(Files, AreCreatedOnce) {
  const int fd = Create("a");
  ASSERT_GE(fd, 0);
  errno = 0;
  EXPECT_EQ(Create("a"), -1);
  EXPECT_EQ(errno, EEXIST);
  close(fd);
  EXPECT_EQ(open((folder_ / "none").c_str(), O_RDONLY), -1);
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(Files, TellSizeKindTimeAndIdentity) {
  WriteFile(folder_ / "a", "12345");
  WriteFile(folder_ / "b", "1");
  struct stat a = {}, b = {}, folder = {}, opened = {};
  ASSERT_EQ(stat((folder_ / "a").c_str(), &a), 0);
  ASSERT_EQ(lstat((folder_ / "b").c_str(), &b), 0);
  ASSERT_EQ(stat(folder_.path().c_str(), &folder), 0);
  const int fd = open((folder_ / "a").c_str(), O_RDONLY | O_NONBLOCK);
  ASSERT_EQ(fstat(fd, &opened), 0);
  close(fd);
  EXPECT_EQ(a.st_size, 5);
  EXPECT_TRUE(S_ISREG(a.st_mode));
  EXPECT_FALSE(S_ISREG(folder.st_mode));
  EXPECT_EQ(a.st_dev, opened.st_dev);
  EXPECT_EQ(a.st_ino, opened.st_ino);
  EXPECT_NE(a.st_ino, b.st_ino);
  EXPECT_EQ(ModifiedNanoseconds(a), ModifiedNanoseconds(opened));
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  const double age = std::chrono::duration<double>(now).count() -
                     1e-9 * static_cast<double>(ModifiedNanoseconds(a));
  EXPECT_LT(std::abs(age), 60);
}

// Also while somebody reads it.
TEST_F(Files, AreReplacedAndRemoved) {
  WriteFile(folder_ / "old", "old");
  WriteFile(folder_ / "new", "new");
  const int reader = open((folder_ / "old").c_str(), O_RDONLY);
  ASSERT_GE(reader, 0);
  EXPECT_EQ(rename((folder_ / "new").c_str(), (folder_ / "old").c_str()), 0);
  EXPECT_EQ(ReadFile(folder_ / "old"), "new");
  char bytes[4] = {};
  EXPECT_EQ(pread(reader, bytes, 3, 0), 3);
  EXPECT_EQ(std::string(bytes), "old");
  close(reader);
  EXPECT_EQ(unlink((folder_ / "old").c_str()), 0);
  EXPECT_EQ(folder_.CountFiles(), 0u);
  EXPECT_EQ(unlink((folder_ / "old").c_str()), -1);
  EXPECT_EQ(errno, ENOENT);
}

TEST_F(Files, AreLockedForOneAtATime) {
  const int first = Create("lock");
  const int second = open((folder_ / "lock").c_str(), O_RDONLY);
  ASSERT_GE(second, 0);
  EXPECT_EQ(flock(first, LOCK_EX), 0);
  errno = 0;
  EXPECT_EQ(flock(second, LOCK_EX | LOCK_NB), -1);
  EXPECT_EQ(errno, EWOULDBLOCK);
  // The lock keeps nobody from reading.
  EXPECT_EQ(write(first, "x", 1), 1);
  char byte = 0;
  EXPECT_EQ(pread(second, &byte, 1, 0), 1);
  close(first);
  EXPECT_EQ(flock(second, LOCK_EX | LOCK_NB), 0);
  close(second);
}

TEST_F(Files, AreTouched) {
  const int fd = Create("a");
  namespace fs = std::filesystem;
  fs::last_write_time(folder_ / "a",
                      fs::file_time_type::clock::now() - std::chrono::hours(1));
  struct stat before = {}, after = {};
  ASSERT_EQ(fstat(fd, &before), 0);
  EXPECT_EQ(futimens(fd, nullptr), 0);
  ASSERT_EQ(fstat(fd, &after), 0);
  close(fd);
  EXPECT_GT(ModifiedNanoseconds(after) - ModifiedNanoseconds(before),
            int64_t{3500} * 1000000000);
}

TEST_F(Files, WithoutADescriptorAreErrors) {
  EXPECT_EQ(SyncFile(-1), -1);
  EXPECT_EQ(errno, EBADF);
  EXPECT_FALSE(IsOnLocalFileSystem(-1));
}

}  // namespace
}  // namespace hpm
