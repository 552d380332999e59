// `hpm_mvs patch_match_stereo`: options in, PatchMatchController, exit code
// out.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/tool/progress_line.h"
#include "src/base/cancel.h"

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace hpm {

// What the command needs from outside; main passes the real things, tests
// theirs.
struct ToolEnvironment {
  std::ostream* out;
  std::ostream* err;
  bool terminal;  // `out` is a terminal that understands control sequences
  int columns;
  ProgressLine::Clock clock;
  const CancelToken* cancel;
  std::function<RunSummary(const ControllerOptions&,
                           const LogSink&,
                           const ProgressSink&,
                           const CancelToken&)>
      run_stereo;
};

// The answer to a question, such as the help. Returns the exit code: lost text
// is an error.
int Print(const std::string& text, const ToolEnvironment& tool);

// `arguments` without the program's name and the command word. Returns the exit
// code (0 or an ErrorCode); throws nothing.
int RunPatchMatchStereo(const std::vector<std::string>& arguments,
                        const ToolEnvironment& tool);

}  // namespace hpm
