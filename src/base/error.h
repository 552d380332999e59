// The one error type of the project: thrown anywhere below colmap_plugin/tool,
// turned into an exit code once, in main.
#pragma once

#include <stdexcept>
#include <string>

namespace hpm {

// The value is the exit code of the program.
enum class ErrorCode {
  kFailure = 1,  // anything unforeseen
  kUsage = 2,    // command line, project file, or a call of the library
  kBadInput =
      3,         // a file of the workspace is missing, damaged or contradictory
  kPartial = 4,  // some images failed, the maps of the others are valid
  kOutOfResources = 5,  // memory or disk
  kDevice = 6,          // the asked-for device cannot be used
  kLocked = 7,          // another run works on this workspace
  kInterrupted = 130,   // SIGINT (SIGTERM exits with 143, SIGHUP 129)
};

class Error : public std::runtime_error {
 public:
  // The message names the file (or option) at fault and the remedy, in one
  // line.
  Error(ErrorCode code, const std::string& message);

  ErrorCode code() const { return code_; }

 private:
  ErrorCode code_;
};

}  // namespace hpm
