#include "colmap_plugin/workspace/file_system.h"

#include "colmap_plugin/formats/atomic_file.h"
#include "src/base/error.h"

#include <algorithm>
#include <iterator>

#include <sys/stat.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/vfs.h>
#else
#include <sys/mount.h>
#include <sys/param.h>
#endif

namespace hpm {

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

std::optional<timespec> FileSystemTime(const std::filesystem::path& folder) {
  const std::filesystem::path file = folder / "clock";
  // Only what has reached a server is stamped by it.
  try {
    WriteFileAtomically(file, "x");
  } catch (const Error&) {
    return std::nullopt;
  }
  struct stat status = {};
  const bool known = stat(file.c_str(), &status) == 0;
  unlink(file.c_str());
  if (!known) return std::nullopt;
#ifdef __APPLE__
  return status.st_mtimespec;
#else
  return status.st_mtim;
#endif
}

}  // namespace hpm
