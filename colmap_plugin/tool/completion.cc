#include "colmap_plugin/tool/completion.h"

#include "colmap_plugin/options/option_table.h"
#include "colmap_plugin/tool/command_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hpm {
namespace {

constexpr char kHead[] =
    R"(# bash completion for hpm_mvs, made by `hpm_mvs help --bash`
_hpm_mvs() {
  local current=${COMP_WORDS[COMP_CWORD]}
  local previous=${COMP_WORDS[COMP_CWORD-1]}
  COMPREPLY=()
  # "--name=value" comes as three words.
  if [[ $current == = ]]; then
    current=
  elif [[ $previous == = ]]; then
    previous=${COMP_WORDS[COMP_CWORD-2]}
  fi
  case $previous in
)";

constexpr char kWords[] = R"(  esac
  if ((COMP_CWORD == 1)) && [[ $current != -* ]]; then
    COMPREPLY=($(compgen -W "{}" -- "$current"))
    return
  fi
  local names="--help {}"
  case ${{COMP_WORDS[1]}} in
{}  esac
  COMPREPLY=($(compgen -W "$names" -- "$current"))
}}
complete -o filenames -F _hpm_mvs hpm_mvs
)";

template <class Option>
std::string ValueCase(const Option& option) {
  const std::string type = TypeText(option);
  std::string reply;
  if (!option.allowed.choices.empty()) {
    reply = fmt::format("-W \"{}\"", fmt::join(option.allowed.choices, " "));
  } else if (type == "bool") {
    reply = "-W \"0 1\"";
  } else if (option.name == "workspace_path") {
    reply = "-d";
  } else if (type == "path" || option.name.find("_path") != std::string::npos) {
    reply = "-f";
  } else {
    return fmt::format("    --{}) return ;;\n", option.name);
  }
  return fmt::format(
      "    --{}) mapfile -t COMPREPLY < <(compgen {} -- \"$current\"); return "
      ";;\n",
      option.name,
      reply);
}

}  // namespace

std::string BashCompletion() {
  std::string text = kHead;
  std::string names;
  for (const OptionSpec& option : OptionTable()) {
    text += ValueCase(option);
    names += (names.empty() ? "--" : " --") + option.name;
  }
  std::string of_commands;
  for (const Command& command : CommandTable()) {
    if (command.description.empty()) continue;
    std::string own;
    for (const CommandOption& option : command.options) {
      text += ValueCase(option);
      own += " --" + option.name;
    }
    for (const OptionSpec& option : OptionTable()) {
      if (command.takes != TakesOptions::kAll && Takes(command, option))
        own += " --" + option.name;
    }
    of_commands +=
        fmt::format("    {}) names=\"{}{}\" ;;\n",
                    command.name,
                    command.takes == TakesOptions::kAll ? "$names" : "--help",
                    own);
  }
  return text + fmt::format(kWords, CommandNames(" "), names, of_commands);
}

}  // namespace hpm
