// --help, --version and docs/options.md, all from the tables of commands and
// options.
#pragma once

#include "colmap_plugin/tool/command_table.h"

#include <string>

namespace hpm {

std::string VersionLine();

std::string HelpText();

// Of a command beside patch_match_stereo.
std::string CommandHelp(const Command& command);

// The contents of docs/options.md.
std::string OptionsMarkdown();

}  // namespace hpm
