#include "colmap_plugin/tool/dispatch.h"

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
  return HelpText();
}

}  // namespace

int RunTool(std::vector<std::string> arguments, const ToolEnvironment& tool) {
  const std::string word = arguments.empty() ? "help" : arguments[0];
  if (word == "version" || word == "--version") {
    return Print(VersionLine() + "\n", tool);
  }
  if (word == "help") {
    return Print(HelpAs(arguments.size() == 2 ? arguments[1] : ""), tool);
  }
  if (word == "patch_match_stereo") {
    arguments.erase(arguments.begin());
  } else if (word.empty() || word[0] != '-') {
    *tool.err << "ERROR: unknown command '" << OneLine(Shortened(word))
              << "'; commands: patch_match_stereo, help, version\n"
              << std::flush;
    return static_cast<int>(ErrorCode::kUsage);
  }
  return RunPatchMatchStereo(arguments, tool);
}

}  // namespace hpm
