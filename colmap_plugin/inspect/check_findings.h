// What a check of the maps found, for people and as an exit code.
#pragma once

#include <string>
#include <vector>

namespace hpm {

enum class FindingKind {
  kDamaged,
  kUnreadable,
  kStale,
  kUnstamped,
  kForeign,
  kMissing
};

struct Finding {
  FindingKind kind;
  std::string what;  // file below the stereo folder, or image and stage
  std::string reason;
  bool removed = false;
};

struct MapCheck {
  std::vector<Finding> findings;
  int num_files = 0;  // read

  int Count(FindingKind kind) const;
  // That of the command: files that the run does not make are no fault.
  int ExitCode() const;
};

// A line per finding and one that counts.
std::string CheckText(const MapCheck& check);

}  // namespace hpm
