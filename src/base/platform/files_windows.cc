#include "src/base/platform/errors.h"
#include "src/base/platform/files.h"

#include <cerrno>

#include <windows.h>

namespace hpm {
namespace {

int ErrnoOf(DWORD error) {
  switch (error) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_DRIVE:
    case ERROR_BAD_NETPATH:
      return ENOENT;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      return EEXIST;
    case ERROR_ACCESS_DENIED:
    case ERROR_SHARING_VIOLATION:
      return EACCES;
    case ERROR_WRITE_PROTECT:
      return EROFS;
    case ERROR_DISK_FULL:
    case ERROR_HANDLE_DISK_FULL:
      return ENOSPC;
    case ERROR_LOCK_VIOLATION:
    case ERROR_IO_PENDING:
      return EWOULDBLOCK;
    case ERROR_TOO_MANY_OPEN_FILES:
      return EMFILE;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_OUTOFMEMORY:
      return ENOMEM;
    case ERROR_FILENAME_EXCED_RANGE:
      return ENAMETOOLONG;
    case ERROR_INVALID_NAME:
    case ERROR_DIRECTORY:
      return ENOTDIR;
    case ERROR_INVALID_HANDLE:
      return EBADF;
    case ERROR_NOT_SUPPORTED:
    case ERROR_INVALID_FUNCTION:
      return ENOTSUP;
    default:
      return EIO;
  }
}

int Fail() {
  errno = ErrnoOf(GetLastError());
  return -1;
}

HANDLE HandleOf(int fd) { return reinterpret_cast<HANDLE>(_get_osfhandle(fd)); }

OVERLAPPED At(int64_t offset) {
  OVERLAPPED place = {};
  place.Offset = static_cast<DWORD>(static_cast<uint64_t>(offset));
  place.OffsetHigh = static_cast<DWORD>(static_cast<uint64_t>(offset) >> 32);
  return place;
}

DWORD Part(size_t num_bytes) {
  constexpr size_t kMost = size_t{1} << 30;
  return static_cast<DWORD>(num_bytes < kMost ? num_bytes : kMost);
}

int Look(HANDLE handle, struct stat* status) {
  BY_HANDLE_FILE_INFORMATION file = {};
  if (!GetFileInformationByHandle(handle, &file)) return Fail();
  const auto joined = [](DWORD high, DWORD low) {
    return (static_cast<uint64_t>(high) << 32) | low;
  };
  status->st_dev = file.dwVolumeSerialNumber;
  status->st_ino = joined(file.nFileIndexHigh, file.nFileIndexLow);
  const bool is_folder =
      (file.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0;
  status->st_mode = is_folder ? _S_IFDIR : _S_IFREG;
  if (GetFileType(handle) != FILE_TYPE_DISK) status->st_mode = _S_IFCHR;
  status->st_size =
      static_cast<int64_t>(joined(file.nFileSizeHigh, file.nFileSizeLow));
  // Windows counts from 1601.
  constexpr int64_t k1970 = 116444736000000000;
  status->modified_100ns =
      static_cast<int64_t>(joined(file.ftLastWriteTime.dwHighDateTime,
                                  file.ftLastWriteTime.dwLowDateTime)) -
      k1970;
  return 0;
}

int LookAt(const wchar_t* path, DWORD extra_flags, struct stat* status) {
  const HANDLE handle =
      CreateFileW(path,
                  FILE_READ_ATTRIBUTES,
                  FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                  nullptr,
                  OPEN_EXISTING,
                  FILE_FLAG_BACKUP_SEMANTICS | extra_flags,
                  nullptr);
  if (handle == INVALID_HANDLE_VALUE) return Fail();
  const int result = Look(handle, status);
  CloseHandle(handle);
  return result;
}

}  // namespace

int ErrnoOf(const std::error_code& error) {
  if (!error || error.category() != std::system_category())
    return error.value();
  return ErrnoOf(static_cast<DWORD>(error.value()));
}

int open(const wchar_t* path, int flags, int) {
  const int how = flags & (_O_RDONLY | _O_WRONLY | _O_RDWR);
  const DWORD access = how == _O_RDWR     ? GENERIC_READ | GENERIC_WRITE
                       : how == _O_WRONLY ? GENERIC_WRITE
                                          : GENERIC_READ;
  const DWORD what = (flags & _O_CREAT) == 0   ? OPEN_EXISTING
                     : (flags & _O_EXCL) != 0  ? CREATE_NEW
                     : (flags & _O_TRUNC) != 0 ? CREATE_ALWAYS
                                               : OPEN_ALWAYS;
  const DWORD link =
      (flags & O_NOFOLLOW) != 0 ? FILE_FLAG_OPEN_REPARSE_POINT : 0;
  const HANDLE handle =
      CreateFileW(path,
                  access,
                  FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE,
                  nullptr,
                  what,
                  FILE_ATTRIBUTE_NORMAL | link,
                  nullptr);
  if (handle == INVALID_HANDLE_VALUE) return Fail();
  const int fd = _open_osfhandle(
      reinterpret_cast<intptr_t>(handle),
      (how == _O_RDONLY ? _O_RDONLY : 0) | _O_BINARY | _O_NOINHERIT);
  if (fd < 0) CloseHandle(handle);
  return fd;
}

ssize_t read(int fd, void* data, size_t num_bytes) {
  return _read(fd, data, Part(num_bytes));
}

ssize_t write(int fd, const void* data, size_t num_bytes) {
  DWORD num_written = 0;
  if (!WriteFile(HandleOf(fd), data, Part(num_bytes), &num_written, nullptr))
    return Fail();
  return static_cast<ssize_t>(num_written);
}

ssize_t pread(int fd, void* data, size_t num_bytes, int64_t offset) {
  OVERLAPPED place = At(offset);
  DWORD num_read = 0;
  if (ReadFile(HandleOf(fd), data, Part(num_bytes), &num_read, &place))
    return static_cast<ssize_t>(num_read);
  return GetLastError() == ERROR_HANDLE_EOF ? 0 : Fail();
}

ssize_t pwrite(int fd, const void* data, size_t num_bytes, int64_t offset) {
  OVERLAPPED place = At(offset);
  DWORD num_written = 0;
  if (!WriteFile(HandleOf(fd), data, Part(num_bytes), &num_written, &place))
    return Fail();
  return static_cast<ssize_t>(num_written);
}

int close(int fd) { return _close(fd); }

int stat(const wchar_t* path, struct stat* status) {
  return LookAt(path, 0, status);
}

int lstat(const wchar_t* path, struct stat* status) {
  return LookAt(path, FILE_FLAG_OPEN_REPARSE_POINT, status);
}

int fstat(int fd, struct stat* status) { return Look(HandleOf(fd), status); }

int unlink(const wchar_t* path) { return DeleteFileW(path) ? 0 : Fail(); }

int rename(const wchar_t* from, const wchar_t* to) {
  return MoveFileExW(from, to, MOVEFILE_REPLACE_EXISTING) ? 0 : Fail();
}

int flock(int fd, int operation) {
  // One byte far behind the end: others can read the file itself.
  OVERLAPPED place = At(int64_t{1} << 62);
  const DWORD flags =
      LOCKFILE_EXCLUSIVE_LOCK |
      ((operation & LOCK_NB) != 0 ? LOCKFILE_FAIL_IMMEDIATELY : 0);
  return LockFileEx(HandleOf(fd), flags, 0, 1, 0, &place) ? 0 : Fail();
}

int futimens(int fd, const void*) {
  FILETIME now = {};
  GetSystemTimeAsFileTime(&now);
  return SetFileTime(HandleOf(fd), nullptr, nullptr, &now) ? 0 : Fail();
}

int SyncFile(int fd) { return FlushFileBuffers(HandleOf(fd)) ? 0 : Fail(); }

int MoveDescriptor(int from, int to) {
  const int result = _dup2(from, to);
  _close(from);
  return result;
}

bool IsOnLocalFileSystem(int fd) {
  FILE_REMOTE_PROTOCOL_INFO remote = {};
  return !GetFileInformationByHandleEx(
      HandleOf(fd), FileRemoteProtocolInfo, &remote, sizeof(remote));
}

bool MayWriteInto(const std::filesystem::path& folder) {
  constexpr int kToWrite = 2;
  return _waccess(folder.c_str(), kToWrite) == 0;
}

int64_t ModifiedNanoseconds(const struct stat& status) {
  return 100 * status.modified_100ns;
}

}  // namespace hpm
