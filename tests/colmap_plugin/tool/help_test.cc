#include "colmap_plugin/tool/help.h"

#include "colmap_plugin/options/option_table.h"
#include "colmap_plugin/tool/command_table.h"
#include "colmap_plugin/tool/completion.h"
#include "colmap_plugin/tool/man_page.h"

#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace hpm {
namespace {

using testing::HasSubstr;

TEST(HelpTest, ListsEveryOptionWithItsDefaultAndRange) {
  const std::string help = HelpText();
  for (const OptionSpec& option : OptionTable()) {
    const std::string value = DefaultText(option);
    EXPECT_THAT(help,
                HasSubstr("  --" + option.name + " arg" +
                          (value.empty() ? "" : " (=" + value + ")") + "\n"));
  }
  EXPECT_THAT(help, HasSubstr("-h [ --help ]"));
  EXPECT_THAT(help, HasSubstr("Allowed: 1 to 32."));
}

TEST(HelpTest, CommonOptionsComeFirst) {
  const std::string help = HelpText();
  EXPECT_LT(help.find("--workspace_path arg"),
            help.find("--PatchMatchStereo.sigma_color"));
  EXPECT_LT(help.find("image_undistorter"), help.find("Common options"));
  EXPECT_EQ(help.find(VersionLine()), 0u);
}

TEST(HelpTest, LinesFitATerminal) {
  const std::string help = HelpText();
  for (size_t begin = 0; begin < help.size();) {
    const size_t end = help.find('\n', begin);
    ASSERT_NE(end, std::string::npos);
    EXPECT_LE(end - begin, 92u) << help.substr(begin, end - begin);
    begin = end + 1;
  }
}

TEST(HelpTest, OptionsDocumentIsUpToDate) {
  std::ifstream file(HPM_OPTIONS_DOC, std::ios::binary);
  const std::string committed((std::istreambuf_iterator<char>(file)), {});
  EXPECT_EQ(committed, OptionsMarkdown())
      << "write it again: hpm_mvs help --markdown > docs/options.md";
}

TEST(HelpTest, ManualPageAndCompletionKnowEveryOption) {
  const std::string page = ManPage();
  const std::string completion = BashCompletion();
  for (const OptionSpec& option : OptionTable()) {
    EXPECT_THAT(page, HasSubstr("\n.BI \\-\\-" + option.name + " \""));
    EXPECT_THAT(completion, HasSubstr(" --" + option.name));
    EXPECT_THAT(completion, HasSubstr("\n    --" + option.name + ") "));
  }
}

TEST(HelpTest, EveryCommandIsInHelpManualCompletionAndDocument) {
  for (const Command& command : CommandTable()) {
    EXPECT_THAT(HelpText(), HasSubstr("\n  " + command.name + "\n"));
    EXPECT_THAT(ManPage(), HasSubstr("\n.B " + command.name + "\n"));
    if (command.description.empty()) continue;
    EXPECT_THAT(OptionsMarkdown(),
                HasSubstr("\n## `hpm_mvs " + command.name + "`\n"));
    EXPECT_THAT(BashCompletion(), HasSubstr("\n    " + command.name + ") "));
    const std::string help = CommandHelp(command);
    EXPECT_THAT(help, HasSubstr("--workspace_path arg"));
    EXPECT_THAT(help, HasSubstr("\nExit codes: "));
    for (const CommandOption& option : command.options) {
      EXPECT_THAT(help, HasSubstr("  --" + option.name + " arg"));
      EXPECT_THAT(OptionsMarkdown(), HasSubstr("\n| `" + option.name + "` | "));
      EXPECT_THAT(BashCompletion(), HasSubstr("\n    --" + option.name + ") "));
    }
  }
  EXPECT_THAT(BashCompletion(), HasSubstr("\"" + CommandNames(" ") + "\""));
}

}  // namespace
}  // namespace hpm
