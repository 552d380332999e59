#include "src/base/platform/errors.h"
#include "src/base/platform/files.h"

#include <algorithm>
#include <cerrno>
#include <iterator>

#ifdef __linux__
#include <sys/vfs.h>
#else
#include <sys/mount.h>
#include <sys/param.h>
#endif

namespace hpm {

int ErrnoOf(const std::error_code& error) { return error.value(); }

int SyncFile(int fd) {
#ifdef F_FULLFSYNC
  // Of Apple's: fsync() there leaves the bytes in the cache of the disk. Some
  // file systems know only that.
  if (fcntl(fd, F_FULLFSYNC) == 0) return 0;
  if (errno != ENOTSUP && errno != EINVAL && errno != ENOTTY) return -1;
#endif
  return fsync(fd);
}

int MoveDescriptor(int from, int to) {
  int result = dup2(from, to);
  if (result >= 0) result = fcntl(to, F_SETFD, FD_CLOEXEC);
  const int error = errno;
  close(from);
  errno = error;
  return result < 0 ? -1 : 0;
}

bool IsOnLocalFileSystem(int fd) {
  struct statfs status = {};
  if (fstatfs(fd, &status) != 0) return false;
#ifdef __linux__
  // statfs(2). A list of the local ones: one that is missing here costs its
  // users minutes of waiting, one too many could cost maps.
  constexpr uint32_t kLocal[] = {
      0xef53,      // ext2, ext3, ext4
      0x58465342,  // XFS
      0x9123683e,  // Btrfs
      0x2fc12fc1,  // ZFS
      0xf2f52010,  // F2FS
      0xca451a4e,  // bcachefs
      0x3153464a,  // JFS
      0x52654973,  // ReiserFS
      0x01021994,  // tmpfs
      0x858458f6,  // ramfs
      0x794c7630,  // overlayfs
      0x4d44,      // FAT
      0x2011bab0,  // exFAT
      0x7366746e,  // NTFS (ntfs3)
  };
  return std::find(std::begin(kLocal),
                   std::end(kLocal),
                   static_cast<uint32_t>(status.f_type)) != std::end(kLocal);
#elif defined(MNT_LOCAL)
  return (status.f_flags & MNT_LOCAL) != 0;
#else
  return false;
#endif
}

bool MayWriteInto(const std::filesystem::path& folder) {
  return access(folder.c_str(), W_OK | X_OK) == 0;
}

int64_t ModifiedNanoseconds(const struct stat& status) {
#ifdef __APPLE__
  const timespec& time = status.st_mtimespec;
#else
  const timespec& time = status.st_mtim;
#endif
  return int64_t{1000000000} * time.tv_sec + time.tv_nsec;
}

}  // namespace hpm
