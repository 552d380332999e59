// Windows' part of files.h, included by it alone.
#pragma once

#include <cstddef>
#include <cstdint>

#include <fcntl.h>
#include <io.h>
#include <sys/stat.h>
#include <sys/types.h>

#ifdef _MSC_VER
using ssize_t = std::ptrdiff_t;
#endif

namespace hpm {

using off_t = int64_t;  // the C library's has 32 bits

// Bits that the C library there does not use. Handles are not inherited and
// bytes not translated in any case; opening never waits.
constexpr int O_CLOEXEC = 1 << 24;
constexpr int O_NONBLOCK = 1 << 25;
constexpr int O_NOFOLLOW = 1 << 26;
constexpr int O_DIRECTORY = 1 << 27;

// `stat` names the structure, too; the time is in units of 100 ns since 1970.
struct stat {
  uint64_t st_dev = 0;
  uint64_t st_ino = 0;
  unsigned st_mode = 0;
  int64_t st_size = 0;
  int64_t modified_100ns = 0;
};

// Others may rename and remove the file while it is open, as on POSIX. A
// folder cannot be opened there: -1 and EACCES.
int open(const wchar_t* path, int flags, int mode = 0);
ssize_t read(int fd, void* data, size_t num_bytes);
ssize_t write(int fd, const void* data, size_t num_bytes);
ssize_t pread(int fd, void* data, size_t num_bytes, int64_t offset);
ssize_t pwrite(int fd, const void* data, size_t num_bytes, int64_t offset);
int close(int fd);
int stat(const wchar_t* path, struct stat* status);
int lstat(const wchar_t* path, struct stat* status);
int fstat(int fd, struct stat* status);
int unlink(const wchar_t* path);
// Replaces what has the other name, also while others read it.
int rename(const wchar_t* from, const wchar_t* to);

// Of flock(2) and futimens(2) what a lock needs: exclusive, of the whole file,
// until it is closed; the present time.
constexpr int LOCK_EX = 2;
constexpr int LOCK_NB = 4;
int flock(int fd, int operation);
int futimens(int fd, const void* now);

}  // namespace hpm

#ifndef S_ISREG
#define S_ISREG(mode) (((mode)&_S_IFMT) == _S_IFREG)
#endif
