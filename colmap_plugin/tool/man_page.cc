#include "colmap_plugin/tool/man_page.h"

#include "colmap_plugin/options/option_table.h"
#include "colmap_plugin/tool/command_table.h"

#include <fmt/format.h>

namespace hpm {
namespace {

constexpr char kHead[] =
    R"(.TH HPM_MVS 1 "" "hpm_mvs )" HPM_VERSION R"(" "User Commands"
.SH NAME
hpm_mvs \- dense stereo for a COLMAP workspace
.SH SYNOPSIS
.B hpm_mvs patch_match_stereo \-\-workspace_path
.I DENSE
.RI [ options ]
.br
.B hpm_mvs
.I COMMAND
.B \-\-workspace_path
.I DENSE
.RI [ options ]
.br
.B hpm_mvs help
.RI [ COMMAND ]
.RB [ \-\-markdown | \-\-man | \-\-bash ]
.br
.B hpm_mvs version
.SH DESCRIPTION
Computes the depth and normal maps of a dense workspace, as
.B colmap image_undistorter
leaves it, in place of
.BR "colmap patch_match_stereo" :
the same options, the same files in, the same files out.
A run that was stopped goes on where it was when the same command is given again.
)";

constexpr char kOptionsHead[] = R"(.SH OPTIONS
Options are written
.BI \-\-name " value"
or
.BI \-\-name= value\fR;
a unique beginning of a name is enough. Booleans are 0/1, true/false, yes/no, on/off.
)";

constexpr char kTail[] = R"(.SH EXIT STATUS
.TP
.B 0
Done.
.TP
.B 1
Unforeseen failure.
.TP
.B 2
Wrong option or project file.
.TP
.B 3
A file of the workspace is missing, damaged or contradictory.
.TP
.B 4
Some images failed, the maps of the others are valid.
.TP
.B 5
Out of memory or disk.
.TP
.B 6
The device cannot be used.
.TP
.B 7
Another run works on this workspace.
.TP
.B 8
With Hpm.shard or Hpm.stage: maps of other shards or stages are not there yet.
.TP
.B 130, 143, 129
Interrupted by SIGINT, SIGTERM, SIGHUP.
.SH EXAMPLE
.nf
colmap image_undistorter \-\-image_path images \-\-input_path sparse/0 \-\-output_path dense
hpm_mvs patch_match_stereo \-\-workspace_path dense
colmap stereo_fusion \-\-workspace_path dense \-\-output_path dense/fused.ply
.fi
.SH SEE ALSO
.BR colmap (1)
)";

// Text of the table as roff takes it: a backslash and a minus sign are written
// so that they stay what they are, and no line begins with a control character.
std::string Roff(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else if ((c == '.' || c == '\'') && out.empty()) {
      out += std::string("\\&") + c;
    } else {
      out += c;
    }
  }
  return out;
}

template <class Option>
std::string Entry(const Option& option, const std::string& no_effect) {
  std::string meaning = option.help + ".";
  if (!option.allowed.text.empty()) {
    meaning += " Allowed: " + option.allowed.text + ".";
  }
  if (!no_effect.empty()) meaning += " No effect: " + no_effect + ".";
  const std::string value = DefaultText(option);
  return fmt::format(".TP\n.BI {} \" {}\"{}\n{}\n",
                     Roff("--" + option.name),
                     TypeText(option),
                     value.empty() ? "" : " \" \\fR(=" + Roff(value) + ")\"",
                     Roff(meaning));
}

std::string Commands() {
  std::string text = ".SH COMMANDS\n";
  for (const Command& command : CommandTable()) {
    text += fmt::format(
        ".TP\n.B {}\n{}\n", command.name, Roff(command.summary + "."));
    if (command.description.empty()) continue;
    text += Roff(command.description) + "\n";
    if (!command.exit_codes.empty())
      text += Roff("Exit codes: " + command.exit_codes + ".") + "\n";
    text += ".RS\n";
    for (const CommandOption& option : command.options)
      text += Entry(option, "");
    text += ".RE\n";
  }
  return text;
}

}  // namespace

std::string ManPage() {
  std::string text = std::string(kHead) + Commands() + kOptionsHead;
  for (const OptionSpec& option : OptionTable())
    text += Entry(option, option.no_effect);
  return text + kTail;
}

}  // namespace hpm
