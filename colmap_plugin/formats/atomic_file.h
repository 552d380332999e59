// A file appears complete or not at all: temporary file in the same folder,
// every write checked, fsync, rename, fsync of the folder (see Durability).
// Errors: kOutOfResources for a full disk, a quota or a file size limit;
// kBadInput for a folder that cannot be written; kFailure for the rest, as
// TransientError (retries.h) where the whole file may be written again: what
// this file does by itself is retried by itself. The program must ignore
// SIGXFSZ, otherwise a file size limit kills it.
#pragma once

#include "colmap_plugin/formats/published_file.h"

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace hpm {

enum class Durability {
  kPowerCut,  // committed files survive a power cut
  // They survive the end of the process. A power cut may leave an older file,
  // none, or, on some file systems, one of the right length with other bytes:
  // for files that can be made again, and whose readers find that out.
  kProcess,
};

// One writer per path at a time within a process.
class AtomicFile {
 public:
  // Creates missing parent folders. The temporary lies beside the file as
  // "hpm_<hash of its name>.tmp.<host>.<machine and container>.<pid>", opened
  // with O_EXCL | O_NOFOLLOW.
  explicit AtomicFile(const std::filesystem::path& path,
                      Durability durability = Durability::kPowerCut);
  ~AtomicFile();  // removes the temporary unless Commit() succeeded
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(const void* data, size_t num_bytes);
  void Write(std::string_view text) { Write(text.data(), text.size()); }
  // Several threads may do so at once; Write() goes on where it was.
  void WriteAt(uint64_t offset, const void* data, size_t num_bytes);

  // What was written is on the disk then, if it has to be, so that Commit() has
  // little to do.
  void Flush();

  // Publishes the file, and tells how it lies there. Throws
  // Error(kOutOfResources) on a full disk or quota, naming the file; nothing is
  // left under the final name then (an older file stays).
  FileState Commit();

 private:
  template <class WriteSome>
  void WriteAll(const void* data,
                size_t num_bytes,
                const WriteSome& write_some);
  [[noreturn]] void Throw(const char* action, int error) const;
  [[noreturn]] void ThrowUnwritten(int error) const;
  bool Rename(const FileState& state) const;
  void SyncFolder() const;

  std::filesystem::path path_;
  Durability durability_;
  std::filesystem::path temporary_;  // empty once it was renamed
  int fd_ = -1;
  std::atomic<uint64_t> num_written_{0};
  uint64_t num_synced_ = UINT64_MAX;  // of these; not yet even the empty file
};

// Retries what passes.
void WriteFileAtomically(const std::filesystem::path& path,
                         std::string_view contents,
                         Durability durability = Durability::kPowerCut);

// Removes temporaries below `folder` whose process is gone (of this machine and
// container only: processes of others cannot be seen, or have others' ids).
// Never throws for files it cannot
// remove.
void RemoveStaleTemporaries(const std::filesystem::path& folder);

}  // namespace hpm
