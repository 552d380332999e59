// The command line of `hpm_mvs patch_match_stereo` with COLMAP's rules:
// --name value and --name=value, unique prefixes, boolean words, an option
// given twice or unknown is an error, stray words are ignored, and with
// --project_path only the ini file counts. All problems are collected, so that
// one try shows all.
#pragma once

#include "colmap_plugin/options/option_table.h"

#include <string>
#include <vector>

namespace hpm {

struct ParsedOptions {
  bool help = false;  // --help or -h was given; then nothing else was checked
  ToolOptions options;
  std::vector<std::string> notes;     // one line each, for the log
  std::vector<std::string> problems;  // one line each; not empty: do not run
};

// `arguments` without the program's name and command word. Never throws for bad
// input.
ParsedOptions ParseOptions(const std::vector<std::string>& arguments);

}  // namespace hpm
