// The one table of the program's commands: dispatch, help, manual page,
// completion and docs/options.md come from it.
#pragma once

#include "colmap_plugin/inspect/export_maps.h"
#include "colmap_plugin/options/option_table.h"

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hpm {

// What the commands beside patch_match_stereo can be told; each has a few of
// these.
struct CommandOptions {
  bool fix = false;
  bool verify = false;
  std::string format = "text";
  double sample_seconds = 30;
  std::filesystem::path report_path;
  ExportOptions export_maps;
};

struct CommandOption {
  std::string name;  // without the leading "--"
  std::function<OptionMember(CommandOptions*)> member;
  Allowed allowed;
  std::string help;  // as OptionSpec::help
};

// Which options of patch_match_stereo the command takes, too.
enum class TakesOptions {
  kNone,
  kWorkspace,  // where the workspace is and how it is laid out
  kAll,
};

struct Command {
  std::string name;
  std::string summary;      // a line of a list
  std::string description;  // what else there is to know, without line breaks
  std::string exit_codes;
  TakesOptions takes = TakesOptions::kNone;
  std::vector<CommandOption> options;
};

// In the order of --help.
const std::vector<Command>& CommandTable();

// nullptr if there is none.
const Command* FindCommand(std::string_view name);

// "patch_match_stereo, check, ...".
std::string CommandNames(const char* separator);

// Whether the command takes this option of patch_match_stereo.
bool Takes(const Command& command, const OptionSpec& option);

std::string DefaultText(const CommandOption& option);
std::string TypeText(const CommandOption& option);
std::string AllowedText(const CommandOption& option);

}  // namespace hpm
