#include "colmap_plugin/tool/help.h"

#include "colmap_plugin/options/option_table.h"
#include "colmap_plugin/tool/text.h"

#include <fmt/format.h>

namespace hpm {
namespace {

struct GroupTitle {
  OptionGroup group;
  const char* title;
};

constexpr GroupTitle kGroups[] = {
    {OptionGroup::kCommon, "Common options"},
    {OptionGroup::kColmap, "COLMAP's other options"},
    {OptionGroup::kExpert, "Expert options"}};

constexpr char kIntroduction[] = R"(
Dense stereo for a COLMAP workspace, in place of `colmap patch_match_stereo`.

Usage:
  hpm_mvs patch_match_stereo --workspace_path DENSE [options]
  hpm_mvs COMMAND --workspace_path DENSE [options]
  hpm_mvs help [COMMAND] | version

Example:
  colmap image_undistorter --image_path images --input_path sparse/0 --output_path dense
  hpm_mvs patch_match_stereo --workspace_path dense
  colmap stereo_fusion --workspace_path dense --output_path dense/fused.ply

Options are written --name value or --name=value; a unique beginning of a name
is enough. Booleans are 0/1, true/false, yes/no, on/off.
)";

constexpr char kExitCodes[] = R"(
Exit codes: 0 done, 1 failure, 2 wrong option, 3 bad input file, 4 some images
failed, 5 out of memory or disk, 6 device, 7 workspace in use, 8 maps of other
shards are missing, 130/143/129 interrupted. A run that was stopped goes on
where it was when the same command is given again.
)";

constexpr char kMarkdownHead[] =
    R"(# Options of `hpm_mvs patch_match_stereo`, and the other commands

This file is the output of `hpm_mvs help --markdown`; a test compares the two.

- `--name value` and `--name=value`. A unique beginning of a name is enough.
- Booleans need a value: `0/1`, `true/false`, `yes/no` or `on/off`, in any case.
- An option that is unknown or given twice, or a value out of range, ends the program with exit
  code 2; all such problems are listed at once. Words without `--` are ignored, as in COLMAP.
- Numbers have a decimal point whatever the locale.
- With `--project_path FILE` only the file counts, as in COLMAP. It holds `name=value` lines,
  either `PatchMatchStereo.filter=1` or `filter=1` below a line `[PatchMatchStereo]`; `#` starts a
  comment. Unknown names are refused.
- Options of COLMAP that mean nothing here are accepted. One that is set to something other than
  its default is named once in the log.
- `PatchMatchStereo.geom_consistency_regularizer` and `.geom_consistency_max_cost` count only when
  they are given: their defaults belong to COLMAP's cost, not to this one.
- *Makes anew*: which finished maps a later run with another value computes again, and all that
  were made from them. `--Hpm.overwrite 1` computes all again.
)";

constexpr char kMarkdownLog[] = R"(
## The log as JSON

With `--Hpm.log_format json` the standard output of `patch_match_stereo` holds one object a line, also for warnings and errors. All have `event` and
`time`, in seconds since the start. Members may be added.

| event | members |
|---|---|
| `options` | `options`: an object with the value of every option, "the method's own" as a number |
| `message` | `level`: `info`, `warning` or `error`; `message` |
| `progress` | `stage`: name in files and stamps; `title`: for people; `image`: empty at the end of a stage; `image_number`, `num_images`: of the stage; `fraction`: of the whole run, by estimated work; `seconds_left`: null while unknown |
| `result` | the last line of a run that came to its end. `exit_code`; `images`: references of the run; `computed`, `kept`: numbers of images; `failed`: their names; `valid_pixel_share`: pixels with a depth, 0..1, of the images computed now, null where there are none; `seconds`; `peak_memory_bytes` |
)";

constexpr char kMarkdownExitCodes[] = R"(
## Exit codes

| code | meaning |
|---|---|
| 0 | done |
| 1 | unforeseen failure |
| 2 | wrong option or project file |
| 3 | a file of the workspace is missing, damaged or contradictory |
| 4 | some images failed, the maps of the others are valid |
| 5 | out of memory or disk |
| 6 | the device cannot be used |
| 7 | another run works on this workspace |
| 8 | with `Hpm.shard` or `Hpm.stage`: maps of other shards or stages are not there yet |
| 130, 143, 129 | interrupted by SIGINT, SIGTERM, SIGHUP |
)";

std::string MarkdownRow(const OptionSpec& option) {
  const std::string value = DefaultText(option);
  std::string help = option.help + ".";
  if (!option.no_effect.empty())
    help += " **No effect**: " + option.no_effect + ".";
  return fmt::format("| `{}` | {} | {} | {} | {} | {} |\n",
                     option.name,
                     TypeText(option),
                     value.empty() ? "" : "`" + value + "`",
                     option.allowed.text,
                     help,
                     ConcernsText(option));
}

// "--name arg (=default)" as COLMAP prints it, the meaning below.
std::string Entry(const std::string& name,
                  const std::string& value,
                  const std::string& help,
                  const std::string& allowed,
                  const std::string& no_effect) {
  std::string meaning = help + ".";
  if (!allowed.empty()) meaning += " Allowed: " + allowed + ".";
  if (!no_effect.empty()) meaning += " No effect: " + no_effect + ".";
  return fmt::format("  --{} arg{}\n{}",
                     name,
                     value.empty() ? "" : " (=" + value + ")",
                     Wrap(meaning, 80, 6));
}

std::string HelpEntry(const OptionSpec& option) {
  return Entry(option.name,
               DefaultText(option),
               option.help,
               option.allowed.text,
               option.no_effect);
}

constexpr char kMarkdownTable[] =
    "| name | type | default | allowed | meaning "
    "|\n|---|---|---|---|---|\n";

// The commands beside patch_match_stereo.
std::string CommandsMarkdown() {
  std::string text;
  for (const Command& command : CommandTable()) {
    if (command.description.empty()) continue;
    text += fmt::format("\n## `hpm_mvs {}`\n\n{}.\n\n{}\n\n",
                        command.name,
                        command.summary,
                        command.description);
    text += command.takes == TakesOptions::kAll
                ? "Takes the options of `patch_match_stereo`, too.\n"
                : "Takes `--workspace_path`, `--workspace_format` and "
                  "`--pmvs_option_name`, too.\n";
    if (!command.options.empty()) text += std::string("\n") + kMarkdownTable;
    for (const CommandOption& option : command.options) {
      const std::string value = DefaultText(option);
      text += fmt::format("| `{}` | {} | {} | {} | {}. |\n",
                          option.name,
                          TypeText(option),
                          value.empty() ? "" : "`" + value + "`",
                          option.allowed.text,
                          option.help);
    }
    if (!command.exit_codes.empty())
      text += "\nExit codes: " + command.exit_codes + ".\n";
  }
  return text;
}

}  // namespace

std::string VersionLine() {
  return "hpm_mvs " HPM_VERSION ", HPM-MVS dense stereo for COLMAP";
}

std::string HelpText() {
  std::string text = VersionLine() + "\n" + kIntroduction + "\nCommands:\n";
  for (const Command& command : CommandTable())
    text += "  " + command.name + "\n" + Wrap(command.summary + ".", 80, 6);
  for (const GroupTitle& group : kGroups) {
    text += fmt::format("\n{}:\n", group.title);
    if (group.group == OptionGroup::kCommon)
      text += "  -h [ --help ]\n      Print this text.\n";
    for (const OptionSpec& option : OptionTable()) {
      if (option.group == group.group) text += HelpEntry(option);
    }
  }
  return text + kExitCodes;
}

std::string CommandHelp(const Command& command) {
  std::string text = fmt::format(
      "hpm_mvs {} --workspace_path DENSE [options]\n\n", command.name);
  text += Wrap(command.summary + ".", 80, 0);
  text += "\n" + Wrap(command.description, 80, 0);
  text += "\nOptions:\n  -h [ --help ]\n      Print this text.\n";
  for (const CommandOption& option : command.options) {
    text += Entry(
        option.name, DefaultText(option), option.help, option.allowed.text, "");
  }
  for (const OptionSpec& option : OptionTable()) {
    const bool shown = command.takes == TakesOptions::kWorkspace ||
                       option.name == "workspace_path";
    if (shown && Takes(command, option)) text += HelpEntry(option);
  }
  if (command.takes == TakesOptions::kAll) {
    text += Wrap(
        "All options of patch_match_stereo are taken, too; hpm_mvs "
        "help lists them.",
        80,
        2);
  }
  if (!command.exit_codes.empty())
    text += "\n" + Wrap("Exit codes: " + command.exit_codes +
                            "; the others as of patch_match_stereo.",
                        80,
                        0);
  return text;
}

std::string OptionsMarkdown() {
  std::string text = kMarkdownHead;
  for (const GroupTitle& group : kGroups) {
    text += fmt::format(
        "\n## {}\n\n| name | type | default | allowed | meaning | "
        "makes anew |\n|---|---|---|---|---|---|\n",
        group.title);
    for (const OptionSpec& option : OptionTable()) {
      if (option.group == group.group) text += MarkdownRow(option);
    }
  }
  return text + kMarkdownExitCodes + kMarkdownLog + CommandsMarkdown();
}

}  // namespace hpm
