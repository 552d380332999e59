#include "colmap_plugin/tool/dispatch.h"

#include "colmap_plugin/tool/command_table.h"
#include "colmap_plugin/tool/completion.h"
#include "colmap_plugin/tool/help.h"
#include "colmap_plugin/tool/man_page.h"
#include "colmap_plugin/tool/text.h"
#include "src/base/error.h"

#include <ostream>

namespace hpm {
namespace {

std::string HelpAs(const std::string& form) {
  if (form == "--markdown") return OptionsMarkdown();
  if (form == "--man") return ManPage();
  if (form == "--bash") return BashCompletion();
  const Command* command = FindCommand(form);
  const bool has_own_help = command != nullptr && !command->description.empty();
  return has_own_help ? CommandHelp(*command) : HelpText();
}

int FailUnknown(const std::string& word, const ToolEnvironment& tool) {
  std::vector<std::string> names;
  for (const Command& command : CommandTable()) names.push_back(command.name);
  const std::string likely = LikelyName(word, names);
  *tool.err << "ERROR: unknown command '" << OneLine(Shortened(word)) << "'"
            << (likely.empty() ? "" : "; did you mean " + likely + "?")
            << "; commands: " << CommandNames(", ") << "\n"
            << std::flush;
  return static_cast<int>(ErrorCode::kUsage);
}

}  // namespace

int RunTool(std::vector<std::string> arguments, const ToolEnvironment& tool) {
  const std::string word = arguments.empty() ? "help" : arguments[0];
  if (word == "version" || word == "--version") {
    return Print(VersionLine() + "\n", tool);
  }
  if (word == "help") {
    const bool is_known = arguments.size() < 2 || arguments[1][0] == '-' ||
                          FindCommand(arguments[1]) != nullptr;
    if (!is_known) return FailUnknown(arguments[1], tool);
    return Print(HelpAs(arguments.size() == 2 ? arguments[1] : ""), tool);
  }
  if (!word.empty() && word[0] == '-')
    return RunPatchMatchStereo(arguments, tool);
  const Command* command = FindCommand(word);
  if (command == nullptr) return FailUnknown(word, tool);
  arguments.erase(arguments.begin());
  return word == "patch_match_stereo" ? RunPatchMatchStereo(arguments, tool)
                                      : RunCommand(*command, arguments, tool);
}

}  // namespace hpm
