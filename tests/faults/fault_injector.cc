// For LD_PRELOAD: one call of the system, or all from one on, fails with a
// given error, if it concerns a file below a given folder. By the environment:
//   HPM_FAULT_ROOT    the folder, a real path
//   HPM_FAULT         <kind>:<number, from 1>:<errno>:<how often, 0: ever
//   after> HPM_FAULT_COUNTS  file that gets "<kind> <calls>" per kind when the
//   program
//                     ends, and "failed <calls>"
// Waits between retries are cut short.
#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include <dlfcn.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

namespace {

enum Kind {
  kOpen,
  kRead,
  kWrite,
  kSync,
  kClose,
  kRename,
  kStat,
  kMkdir,
  kUnlink,
  kNumKinds
};
constexpr const char* kNames[kNumKinds] = {"open",
                                           "read",
                                           "write",
                                           "fsync",
                                           "close",
                                           "rename",
                                           "stat",
                                           "mkdir",
                                           "unlink"};

struct Injector {
  Injector() {
    if (const char* text = std::getenv("HPM_FAULT_ROOT")) root = text;
    if (const char* path = std::getenv("HPM_FAULT_COUNTS")) counts_path = path;
    const char* fault = std::getenv("HPM_FAULT");
    char name[16] = {};
    if (fault != nullptr &&
        std::sscanf(
            fault, "%15[a-z]:%ld:%d:%ld", name, &number, &error, &times) == 4) {
      for (int i = 0; i < kNumKinds; ++i) {
        if (std::strcmp(name, kNames[i]) == 0) kind = i;
      }
    }
  }

  ~Injector() {
    if (counts_path.empty()) return;
    std::string text = "failed " + std::to_string(num_failed.load()) + "\n";
    for (int i = 0; i < kNumKinds; ++i)
      text += kNames[i] + (" " + std::to_string(counts[i].load())) + "\n";
    const long fd = syscall(SYS_openat,
                            AT_FDCWD,
                            counts_path.c_str(),
                            O_WRONLY | O_CREAT | O_TRUNC,
                            0644);
    if (syscall(SYS_write, fd, text.data(), text.size()) < 0) return;
    syscall(SYS_close, fd);
  }

  // Sets errno if the call has to fail.
  bool Fails(Kind which) {
    const long at = ++counts[which];
    if (which != kind || at < number || (times > 0 && at >= number + times))
      return false;
    ++num_failed;
    errno = error;
    return true;
  }

  bool Concerns(const char* path) const {
    return !root.empty() && path != nullptr &&
           std::strncmp(path, root.c_str(), root.size()) == 0;
  }
  bool Concerns(int fd) const {
    if (root.empty() || fd <= 2) return false;
    char name[32];
    std::snprintf(name, sizeof(name), "/proc/self/fd/%d", fd);
    char path[4096];
    const int saved = errno;
    const long length =
        syscall(SYS_readlinkat, AT_FDCWD, name, path, sizeof(path) - 1);
    errno = saved;
    if (length < 0) return false;
    path[length] = '\0';
    return Concerns(path);
  }
  template <class File>
  bool Fails(Kind which, File file) {
    return Concerns(file) && Fails(which);
  }

  std::string root, counts_path;
  int kind = kNumKinds;
  long number = 0, times = 0;
  int error = 0;
  std::atomic<long> counts[kNumKinds] = {};
  std::atomic<long> num_failed{0};
};

// Calls come before this file's own statics are made.
Injector& The() {
  static Injector injector;
  return injector;
}

template <class Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

int Open(int folder, const char* path, int flags, mode_t mode) {
  if (The().Fails(kOpen, path)) return -1;
  return static_cast<int>(syscall(SYS_openat, folder, path, flags, mode));
}

ssize_t PRead(int fd, void* data, size_t count, off_t offset) {
  if (The().Fails(kRead, fd)) return -1;
  return syscall(SYS_pread64, fd, data, count, offset);
}

ssize_t Read(int fd, void* data, size_t count) {
  if (The().Fails(kRead, fd)) return -1;
  return syscall(SYS_read, fd, data, count);
}

ssize_t PWrite(int fd, const void* data, size_t count, off_t offset) {
  if (The().Fails(kWrite, fd)) return -1;
  return syscall(SYS_pwrite64, fd, data, count, offset);
}

}  // namespace

#define MODE_ARGUMENT(flags)                      \
  mode_t mode = 0;                                \
  if (((flags) & (O_CREAT | __O_TMPFILE)) != 0) { \
    va_list arguments;                            \
    va_start(arguments, flags);                   \
    mode = va_arg(arguments, mode_t);             \
    va_end(arguments);                            \
  }

extern "C" {

int open(const char* path, int flags, ...) {
  MODE_ARGUMENT(flags)
  return Open(AT_FDCWD, path, flags, mode);
}
int open64(const char* path, int flags, ...) {
  MODE_ARGUMENT(flags)
  return Open(AT_FDCWD, path, flags, mode);
}
int openat(int folder, const char* path, int flags, ...) {
  MODE_ARGUMENT(flags)
  return Open(folder, path, flags, mode);
}
int __open_2(const char* path, int flags) {
  return Open(AT_FDCWD, path, flags, 0);
}
int __open64_2(const char* path, int flags) {
  return Open(AT_FDCWD, path, flags, 0);
}

ssize_t read(int fd, void* data, size_t count) { return Read(fd, data, count); }
ssize_t __read_chk(int fd, void* data, size_t count, size_t) {
  return Read(fd, data, count);
}
ssize_t pread(int fd, void* data, size_t count, off_t offset) {
  return PRead(fd, data, count, offset);
}
ssize_t pread64(int fd, void* data, size_t count, off_t offset) {
  return PRead(fd, data, count, offset);
}
ssize_t __pread_chk(int fd, void* data, size_t count, off_t offset, size_t) {
  return PRead(fd, data, count, offset);
}
ssize_t __pread64_chk(int fd, void* data, size_t count, off_t offset, size_t) {
  return PRead(fd, data, count, offset);
}

ssize_t write(int fd, const void* data, size_t count) {
  if (The().Fails(kWrite, fd)) return -1;
  return syscall(SYS_write, fd, data, count);
}
ssize_t pwrite(int fd, const void* data, size_t count, off_t offset) {
  return PWrite(fd, data, count, offset);
}
ssize_t pwrite64(int fd, const void* data, size_t count, off_t offset) {
  return PWrite(fd, data, count, offset);
}

int fsync(int fd) {
  if (The().Fails(kSync, fd)) return -1;
  return static_cast<int>(syscall(SYS_fsync, fd));
}

// Linux closes the file even if it fails.
int close(int fd) {
  const bool fails = The().Fails(kClose, fd);
  const int error = errno;
  const int result = static_cast<int>(syscall(SYS_close, fd));
  if (!fails) return result;
  errno = error;
  return -1;
}

int rename(const char* from, const char* to) noexcept {
  if (The().Fails(kRename, to)) return -1;
  return static_cast<int>(
      syscall(SYS_renameat2, AT_FDCWD, from, AT_FDCWD, to, 0));
}

int stat(const char* path, struct stat* status) noexcept {
  if (The().Fails(kStat, path)) return -1;
  return Real<int(const char*, struct stat*)>("stat")(path, status);
}
int stat64(const char* path, struct stat64* status) noexcept {
  if (The().Fails(kStat, path)) return -1;
  return Real<int(const char*, struct stat64*)>("stat64")(path, status);
}

int mkdir(const char* path, mode_t mode) noexcept {
  if (The().Fails(kMkdir, path)) return -1;
  return static_cast<int>(syscall(SYS_mkdirat, AT_FDCWD, path, mode));
}

int unlink(const char* path) noexcept {
  if (The().Fails(kUnlink, path)) return -1;
  return static_cast<int>(syscall(SYS_unlinkat, AT_FDCWD, path, 0));
}
int remove(const char* path) noexcept {
  if (The().Fails(kUnlink, path)) return -1;
  return Real<int(const char*)>("remove")(path);
}

int nanosleep(const timespec*, timespec*) { return 0; }
int clock_nanosleep(clockid_t, int, const timespec*, timespec*) { return 0; }

}  // extern "C"
