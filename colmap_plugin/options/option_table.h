// The one table of all options of `hpm_mvs patch_match_stereo`: names as in
// COLMAP 3.8 and 4.x (see docs/options.md), plus "Hpm.*". Parsing, --help, the
// manual page, completion, docs/options.md, the fingerprints of maps
// (option_fingerprint.h) and the run record (option_record.h) come from it;
// defaults are those of the structs. So a new option is a member in options.h,
// a row here, and its use.
#pragma once

#include "colmap_plugin/options/option_value.h"
#include "colmap_plugin/options/options.h"

#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace hpm {

enum class OptionGroup { kCommon, kColmap, kExpert };

// Which maps are made anew when an option changes: those of the stages named
// here, and of all that read them.
enum class Concerns {
  // The value is in the fingerprint of
  kAllStages,
  kGeometricStages,
  kFinalStage,
  // The value is not in any fingerprint, but what follows from it is:
  kPasses,        // the passes of each stage
  kInputs,        // images, cameras, sources and depth range of each problem
  kOtherOptions,  // values of other options
  // Nothing is made anew:
  kRounding,  // the last digits may differ; one map is as good as the other
  kNothing,   // no byte of a map depends on it
};

struct OptionSpec {
  OptionGroup group;
  Concerns concerns;
  std::string name;  // without the leading "--"
  std::function<OptionMember(ToolOptions*)> member;
  Allowed allowed;
  std::string help;       // one sentence or two, without the final full stop
  std::string no_effect;  // not empty: accepted for COLMAP's sake, and why it
                          // does nothing
};

// In the order of --help within a group.
const std::vector<OptionSpec>& OptionTable();

// nullptr if there is none.
const OptionSpec* FindOption(std::string_view name);

std::string DefaultText(const OptionSpec& option);
std::string TypeText(const OptionSpec& option);
// Type and range, for messages: "int, 1 to 32".
std::string AllowedText(const OptionSpec& option);
// What is computed anew when it changes, for people: "all stages".
std::string ConcernsText(const OptionSpec& option);

}  // namespace hpm
