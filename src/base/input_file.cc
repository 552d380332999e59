#include "src/base/input_file.h"

#include "src/base/platform/files.h"
#include "src/base/retries.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

namespace hpm {
namespace {

[[noreturn]] void ThrowCannotRead(const std::filesystem::path& path,
                                  int error) {
  throw UnreadableFile(fmt::format(
      "cannot read {}: {}; {}",
      path.string(),
      std::generic_category().message(error),
      IsTransient(error) ? "check the disk or its server and run again"
                         : "check that the file exists and is readable"));
}

// O_NONBLOCK: opening a FIFO without a writer must return, so that it can be
// refused.
int OpenToRead(const std::filesystem::path& path, struct stat* status) {
  const int fd = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd < 0 || fstat(fd, status) == 0) return fd;
  const int error = errno;
  close(fd);
  errno = error;
  return -1;
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  struct stat status = {};
  fd_ = RetryCall(path, [&] { return OpenToRead(path, &status); });
  if (fd_ < 0) ThrowCannotRead(path, errno);
  if (!S_ISREG(status.st_mode)) {
    close(fd_);
    throw UnreadableFile(fmt::format(
        "{} is not a regular file; give the path of a file", path.string()));
  }
  size_ = static_cast<uint64_t>(status.st_size);
  time_ns_ = ModifiedNanoseconds(status);
}

InputFile::~InputFile() { close(fd_); }

size_t InputFile::ReadAt(uint64_t offset, void* data, size_t num_bytes) const {
  Retries retries(path_);
  size_t num_read = 0;
  int error = 0;
  while (num_read < num_bytes) {
    // A stale handle stays so: the next try opens the file again.
    const bool reopen = error != 0 && error != EINTR;
    const ssize_t n = reopen && !Reopen()
                          ? -1
                          : pread(fd_,
                                  static_cast<char*>(data) + num_read,
                                  num_bytes - num_read,
                                  static_cast<off_t>(offset + num_read));
    error = n < 0 ? errno : 0;
    if (n == 0) break;
    if (n > 0) {
      num_read += static_cast<size_t>(n);
    } else if (!retries.Again(error)) {
      ThrowCannotRead(path_, error);
    }
  }
  return num_read;
}

bool InputFile::Reopen() const {
  struct stat status = {};
  const int fd = OpenToRead(path_, &status);
  if (fd < 0) return false;
  if (S_ISREG(status.st_mode) &&
      static_cast<uint64_t>(status.st_size) == size_ &&
      ModifiedNanoseconds(status) == time_ns_) {
    return MoveDescriptor(fd, fd_) == 0;
  }
  close(fd);
  errno = ENOENT;  // what was being read is gone
  return false;
}

std::string ReadWholeFile(const std::filesystem::path& path,
                          uint64_t max_bytes) {
  const InputFile file(path);
  if (file.size() > max_bytes) {
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} has {} bytes, at most {} are read; check what "
                            "lies there",
                            path.string(),
                            file.size(),
                            max_bytes));
  }
  std::string text(file.size(), '\0');
  text.resize(file.ReadAt(0, text.data(), text.size()));
  return text;
}

}  // namespace hpm
