// The one table of all options of `hpm_mvs patch_match_stereo`: names as in
// COLMAP 3.8 and 4.x (see docs/options.md), plus "Hpm.*". Parsing, --help and
// docs/options.md come from it. Defaults are those of the structs.
#pragma once

#include "colmap_plugin/controller/options.h"
#include "colmap_plugin/tool/option_value.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hpm {

// COLMAP's options about its own logging; accepted, never read.
struct LogOptions {
  bool log_to_stderr = false;                  // up to 3.13
  std::string log_target = "stderr_and_file";  // 4.0 and later, as all below
  std::string log_path;
  int log_level = 0;
  int log_severity = 0;
  bool log_color = true;
};

struct ToolOptions {
  std::string project_path;
  ControllerOptions controller;
  LogOptions log;
};

enum class OptionGroup { kCommon, kColmap, kExpert };

struct OptionSpec {
  OptionGroup group;
  std::string name;  // without the leading "--"
  std::function<OptionMember(ToolOptions*)> member;
  Allowed allowed;
  std::string help;       // one sentence or two, without the final full stop
  std::string no_effect;  // not empty: accepted for COLMAP's sake, and why it
                          // does nothing
};

// In the order of --help within a group.
const std::vector<OptionSpec>& OptionTable();

// nullptr if there is none.
const OptionSpec* FindOption(std::string_view name);

std::string DefaultText(const OptionSpec& option);
std::string TypeText(const OptionSpec& option);
// Type and range, for messages: "int, 1 to 32".
std::string AllowedText(const OptionSpec& option);

}  // namespace hpm
