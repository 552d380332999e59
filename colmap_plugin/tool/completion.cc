#include "colmap_plugin/tool/completion.h"

#include "colmap_plugin/options/option_table.h"

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
    COMPREPLY=($(compgen -W "patch_match_stereo help version" -- "$current"))
    return
  fi
  COMPREPLY=($(compgen -W "--help {}" -- "$current"))
}}
complete -o filenames -F _hpm_mvs hpm_mvs
)";

std::string ValueCase(const OptionSpec& option) {
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
  return text + fmt::format(kWords, names);
}

}  // namespace hpm
