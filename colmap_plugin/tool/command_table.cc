#include "colmap_plugin/tool/command_table.h"

#include <utility>

namespace hpm {
namespace {

template <class T>
CommandOption Row(std::string name,
                  T CommandOptions::*member,
                  Allowed allowed,
                  std::string help) {
  return {std::move(name),
          [member](CommandOptions* options) {
            return OptionMember(&(options->*member));
          },
          std::move(allowed),
          std::move(help)};
}

std::vector<Command> MakeTable() {
  using C = CommandOptions;
  return {
      // A table reads better packed.
      // clang-format off
      {"patch_match_stereo", "Compute the depth and normal maps of a workspace",
       "", "", TakesOptions::kAll, {}},
      {"check", "Validate all maps of a workspace and name those that are damaged, stale, foreign or missing",
       "Reads every depth map, normal map, consistency graph and stamp: header and length, checksum, finite "
       "values, depths that are not negative and inside a range given by hand, normals of length one, and the "
       "size that the image has in the run. Give the options of the run: maps made with others are stale. Each "
       "finding is one line: 'damaged' is of no use to anybody; 'stale' was made with other options, from other "
       "images or by another version; 'foreign' was made by another program or belongs to no image of the model; "
       "'missing' is what the next run makes. Nothing is changed without --fix 1.",
       "0 all is there and good, 3 something is damaged, 4 nothing is damaged, but the next run has something to do",
       TakesOptions::kAll,
       {Row("fix", &C::fix, Anything(),
            "Remove what is damaged, so that the next run makes only that; stale and foreign files stay")}},
      {"help", "Print this text; help COMMAND: what a command does and takes; help --markdown, --man, --bash: as a "
       "document, manual page, completion", "", "", TakesOptions::kNone, {}},
      {"version", "Print the version", "", "", TakesOptions::kNone, {}},
      // clang-format on
  };
}

}  // namespace

const std::vector<Command>& CommandTable() {
  static const std::vector<Command> table = MakeTable();
  return table;
}

const Command* FindCommand(std::string_view name) {
  for (const Command& command : CommandTable()) {
    if (command.name == name) return &command;
  }
  return nullptr;
}

std::string CommandNames(const char* separator) {
  std::string names;
  for (const Command& command : CommandTable())
    names += (names.empty() ? "" : separator) + command.name;
  return names;
}

bool Takes(const Command& command, const OptionSpec& option) {
  if (command.takes != TakesOptions::kWorkspace)
    return command.takes == TakesOptions::kAll;
  for (const char* name :
       {"workspace_path", "workspace_format", "pmvs_option_name"}) {
    if (option.name == name) return true;
  }
  return false;
}

std::string DefaultText(const CommandOption& option) {
  CommandOptions defaults;
  return FormatValue(option.member(&defaults));
}

std::string TypeText(const CommandOption& option) {
  CommandOptions defaults;
  return TypeName(option.member(&defaults));
}

std::string AllowedText(const CommandOption& option) {
  const std::string type = TypeText(option);
  if (type == "bool") return "0/1, true/false, yes/no or on/off";
  return option.allowed.text.empty() ? type : type + ", " + option.allowed.text;
}

}  // namespace hpm
