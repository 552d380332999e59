// One run per workspace: stereo/hpm_mvs/lock names the run that works on it.
#pragma once

#include <filesystem>
#include <string>

namespace hpm {

// The file is created with O_EXCL and holds host, process id, the start time of
// that process (a reused id is told apart by it; skipped where there is no
// /proc) and its process id name space (containers of one host cannot see each
// other's processes). The lock of a dead process of this host and name space is
// taken over; of several takers exactly one wins.
class RunLock {
 public:
  // Throws Error(kLocked) naming host, process and remedy if another run (or
  // another RunLock of this process) holds the lock; Error(kBadInput,
  // kOutOfResources) if the file cannot be written.
  explicit RunLock(const std::filesystem::path& state_path);
  ~RunLock();  // removes the file if it is still this lock's
  RunLock(const RunLock&) = delete;
  RunLock& operator=(const RunLock&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  bool TryCreate();

  std::filesystem::path path_;
  std::string contents_;
};

}  // namespace hpm
