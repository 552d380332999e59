#include "colmap_plugin/tool/dispatch.h"

#include "colmap_plugin/tool/help.h"
#include "colmap_plugin/tool/text.h"
#include "src/base/error.h"

#include <ostream>

namespace hpm {

int RunTool(std::vector<std::string> arguments, const ToolEnvironment& tool) {
  const std::string word = arguments.empty() ? "help" : arguments[0];
  if (word == "version" || word == "--version") {
    *tool.out << VersionLine() << '\n' << std::flush;
    return 0;
  }
  if (word == "help") {
    const bool markdown = arguments.size() == 2 && arguments[1] == "--markdown";
    *tool.out << (markdown ? OptionsMarkdown() : HelpText()) << std::flush;
    return 0;
  }
  if (word == "patch_match_stereo") {
    arguments.erase(arguments.begin());
  } else if (word.empty() || word[0] != '-') {
    *tool.err << "ERROR: unknown command '" << OneLine(word)
              << "'; commands: patch_match_stereo, help, version\n"
              << std::flush;
    return static_cast<int>(ErrorCode::kUsage);
  }
  return RunPatchMatchStereo(arguments, tool);
}

}  // namespace hpm
