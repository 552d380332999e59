// The commands: options in, PatchMatchController or what else does the work,
// exit code out.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "colmap_plugin/tool/command_table.h"
#include "colmap_plugin/tool/progress_line.h"
#include "src/base/cancel.h"

#include <functional>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace hpm {

// What a command beside patch_match_stereo gets.
struct CommandCall {
  ControllerOptions options;
  CommandOptions own;
  LogSink log;
  std::function<int(const std::string&)> print;  // Print() below
  const CancelToken* cancel;
};
// Returns the exit code; throws what the controller throws.
using CommandRun = std::function<int(const CommandCall&)>;

// What the commands need from outside; main passes the real things, tests
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
  // Of the commands beside patch_match_stereo, by name.
  std::map<std::string, CommandRun> commands = {};
};

// The answer to a question, such as the help. Returns the exit code: lost text
// is an error.
int Print(const std::string& text, const ToolEnvironment& tool);

// `arguments` without the program's name and the command word. Returns the exit
// code (0 or an ErrorCode); throws nothing.
int RunPatchMatchStereo(const std::vector<std::string>& arguments,
                        const ToolEnvironment& tool);

// The same of any other command of the table.
int RunCommand(const Command& command,
               const std::vector<std::string>& arguments,
               const ToolEnvironment& tool);

}  // namespace hpm
