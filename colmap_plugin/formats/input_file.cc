#include "colmap_plugin/formats/input_file.h"

#include "src/base/error.h"
#include "src/base/platform/files.h"

#include <cerrno>
#include <system_error>

#include <fmt/format.h>

namespace hpm {
namespace {

[[noreturn]] void ThrowCannotRead(const std::filesystem::path& path,
                                  int error) {
  throw Error(
      ErrorCode::kBadInput,
      fmt::format(
          "cannot read {}: {}; check that the file exists and is readable",
          path.string(),
          std::generic_category().message(error)));
}

}  // namespace

InputFile::InputFile(const std::filesystem::path& path) : path_(path) {
  // O_NONBLOCK: opening a FIFO without a writer must return, so that it can be
  // refused.
  fd_ = open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
  if (fd_ < 0) ThrowCannotRead(path, errno);
  struct stat status = {};
  const int error = fstat(fd_, &status) == 0 ? 0 : errno;
  if (error != 0 || !S_ISREG(status.st_mode)) {
    close(fd_);
    if (error != 0) ThrowCannotRead(path, error);
    throw Error(ErrorCode::kBadInput,
                fmt::format("{} is not a regular file; give the path of a file",
                            path.string()));
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

InputFile::~InputFile() { close(fd_); }

size_t InputFile::ReadAt(uint64_t offset, void* data, size_t num_bytes) const {
  size_t num_read = 0;
  while (num_read < num_bytes) {
    const ssize_t n = pread(fd_,
                            static_cast<char*>(data) + num_read,
                            num_bytes - num_read,
                            static_cast<off_t>(offset + num_read));
    if (n == 0) break;
    if (n > 0) {
      num_read += static_cast<size_t>(n);
    } else if (errno != EINTR) {
      ThrowCannotRead(path_, errno);
    }
  }
  return num_read;
}

void InputCursor::FailAt(uint64_t place, const std::string& what) const {
  throw Error(ErrorCode::kBadInput, Message(place, what));
}

}  // namespace hpm
