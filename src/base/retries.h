// Errors that pass by themselves: a network file system whose server starts
// anew answers EIO, handles go stale when another machine replaces a file
// (ESTALE). What failed so is tried again a few times, in growing intervals.
// What was written is never trusted after such an error: the kernel may have
// dropped it (fsync(2)), so files are written anew as a whole (TransientError).
#pragma once

#include "src/base/cancel.h"
#include "src/base/error.h"
#include "src/base/log.h"
#include "src/base/platform/errors.h"

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <string>
#include <system_error>

namespace hpm {

// EIO, ESTALE, EAGAIN, ETIMEDOUT; not EINTR, after which any call is made again
// at once.
bool IsTransient(int error);
// Error(kBadInput): nobody may take a file for absent whose disk does not
// answer.
void ThrowIfTransient(int error, const std::filesystem::path& path);

struct RetryRules {
  int max_tries = 5;  // beside the first
  std::chrono::milliseconds first_wait = std::chrono::milliseconds(100);
  int growth = 3;  // of each wait over the one before: 12 seconds in all
};

// While it lives, retries of this process are told to `log` and end when
// `cancel` is cancelled. The innermost counts.
class RetryScope {
 public:
  RetryScope(LogSink log, const CancelToken* cancel, RetryRules rules = {});
  ~RetryScope();
  RetryScope(const RetryScope&) = delete;
  RetryScope& operator=(const RetryScope&) = delete;
};

// Of one operation on one file.
class Retries {
 public:
  explicit Retries(const std::filesystem::path& path) : path_(path) {}

  // After a failed try: true if the next is to be made, now. Throws
  // Error(kInterrupted).
  bool Again(int error);

 private:
  const std::filesystem::path& path_;
  int num_tries_ = 0;
};

// A file was written in vain; the whole of it may be written again.
class TransientError : public Error {
 public:
  TransientError(int error,
                 const std::filesystem::path& path,
                 const std::string& message)
      : Error(ErrorCode::kFailure, message), error_(error), path_(path) {}
  int error() const { return error_; }
  const std::filesystem::path& path() const { return path_; }

 private:
  int error_;
  std::filesystem::path path_;
};

// call(): as system calls, negative with errno set if it fails. Returns what
// the last try does, errno with it.
template <class Call>
auto RetryCall(const std::filesystem::path& path, const Call& call) {
  Retries retries(path);
  while (true) {
    const auto result = call();
    if (result >= 0) return result;
    const int error = errno;
    if (!retries.Again(error)) {
      errno = error;
      return result;
    }
  }
}

// call(&error_code): as the functions of std::filesystem.
template <class Call>
auto RetryFileSystem(const std::filesystem::path& path, const Call& call) {
  Retries retries(path);
  while (true) {
    std::error_code error;
    const auto result = call(error);
    if (!error || !retries.Again(ErrnoOf(error))) return result;
  }
}

// write(): writes files from the beginning, with what AtomicFile throws.
template <class Write>
auto RetryWriting(const Write& write) {
  std::filesystem::path path;
  Retries retries(path);
  while (true) {
    try {
      return write();
    } catch (const TransientError& error) {
      path = error.path();
      if (!retries.Again(error.error())) throw;
    }
  }
}

// Throw Error(kBadInput) where the disk does not answer; other errors are no.
bool Exists(const std::filesystem::path& path);
bool IsFolder(const std::filesystem::path& path);
bool IsRegularFile(const std::filesystem::path& path);
// With those above it.
std::error_code MakeFolder(const std::filesystem::path& path);

}  // namespace hpm
