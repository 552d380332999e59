// The command line of a command beside patch_match_stereo: its own options, and
// those of patch_match_stereo that it takes, by the same rules.
#pragma once

#include "colmap_plugin/tool/command_table.h"
#include "colmap_plugin/tool/parse_options.h"

#include <string>
#include <vector>

namespace hpm {

struct ParsedCommand {
  ParsedOptions run;  // its problems are of all options
  CommandOptions own;
};

// `arguments` without the program's name and command word. Never throws for bad
// input.
ParsedCommand ParseCommand(const Command& command,
                           const std::vector<std::string>& arguments);

}  // namespace hpm
