// Picks the command from the first word.
#pragma once

#include "colmap_plugin/tool/run_command.h"

#include <string>
#include <vector>

namespace hpm {

// `arguments` without the program's name. A first argument that begins with '-'
// belongs to patch_match_stereo; without arguments the help is printed. Returns
// the exit code.
int RunTool(std::vector<std::string> arguments, const ToolEnvironment& tool);

}  // namespace hpm
