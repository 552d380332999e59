#include "colmap_plugin/tool/parse_options.h"

#include "colmap_plugin/options/quality.h"
#include "colmap_plugin/tool/text.h"
#include "src/base/error.h"
#include "src/base/input_file.h"

#include <cstdint>
#include <map>
#include <sstream>

#include <boost/program_options.hpp>
#include <fmt/format.h>

namespace hpm {
namespace {

namespace po = boost::program_options;

// No path may be longer, and nothing else has reason to.
constexpr size_t kMaxValueLength = 4095;
constexpr uint64_t kMaxProjectFileBytes = 1 << 20;

// Boost only splits the text; types and ranges are ours, since Boost converts
// numbers by the global locale.
po::options_description Describe() {
  po::options_description description;
  for (const OptionSpec& option : OptionTable()) {
    description.add_options()(
        option.name.c_str(), po::value<std::string>(), "");
  }
  return description;
}

// "; did you mean --PatchMatchStereo.max_image_size?" for "--max_image_size",
// or a name that is nearly the same.
std::string Suggestion(const std::string& unknown) {
  std::string word = unknown.substr(0, unknown.find('='));
  word.erase(0, word.find_first_not_of('-'));
  word.erase(0, word.rfind('.') + 1);
  if (word.empty()) return "";
  const std::string suffix = "." + word;
  std::string names;
  for (const OptionSpec& option : OptionTable()) {
    const bool ends =
        option.name.size() > suffix.size() &&
        option.name.compare(
            option.name.size() - suffix.size(), suffix.size(), suffix) == 0;
    if (option.name == word || ends)
      names += (names.empty() ? "--" : " or --") + option.name;
  }
  if (names.empty()) {
    std::string written = unknown.substr(0, unknown.find('='));
    written.erase(0, written.find_first_not_of('-'));
    std::vector<std::string> all;
    for (const OptionSpec& option : OptionTable()) all.push_back(option.name);
    const std::string likely = LikelyName(written, all);
    if (!likely.empty()) names = "--" + likely;
  }
  return names.empty() ? "" : "; did you mean " + names + "?";
}

class Interpreter {
 public:
  explicit Interpreter(ParsedOptions* result) : result_(result) {}

  // Takes the values that Boost split. `source` begins the message about an
  // unknown option, e.g. "project.ini: ".
  void Take(const po::parsed_options& parsed, const std::string& source) {
    for (const po::option& option : parsed.options) {
      if (option.unregistered) {
        const std::string name = option.original_tokens.empty()
                                     ? option.string_key
                                     : option.original_tokens[0];
        Problem(fmt::format("{}unknown option '{}'{}",
                            source,
                            Shortened(name),
                            Suggestion(name)));
      } else if (option.string_key.empty()) {
        for (const std::string& word : option.value) {
          // COLMAP does not even say so.
          result_->notes.push_back(fmt::format(
              "'{}' is ignored: it is neither an option nor the value of one",
              OneLine(Shortened(word))));
        }
      } else if (option.value.size() == 1) {
        TakeValue(option.string_key, option.value[0]);
      }
    }
  }

  // The rules between options, and what follows from them.
  void Finish() {
    const ControllerOptions& options = result_->options.controller;
    if (options.workspace.path.empty()) {
      Problem("the option '--workspace_path' is required but missing");
    }
    if (given_.count("random_seed") && given_.count("default_random_seed") &&
        given_["random_seed"] != given_["default_random_seed"]) {
      Problem(
          fmt::format("--random_seed '{}' and --default_random_seed '{}' "
                      "contradict each other;"
                      " allowed: one of the two, or the same number",
                      Shortened(given_["random_seed"]),
                      Shortened(given_["default_random_seed"])));
    }
    const double depth_min = options.problems.depth_min;
    const double depth_max = options.problems.depth_max;
    const bool automatic = depth_min == -1 && depth_max == -1;
    if (!automatic && !(depth_min >= 0 && depth_min <= depth_max)) {
      Problem(
          fmt::format("--PatchMatchStereo.depth_min '{}' with "
                      "--PatchMatchStereo.depth_max '{}'"
                      " is not allowed; allowed: {}",
                      depth_min,
                      depth_max,
                      FindOption("PatchMatchStereo.depth_min")->allowed.text));
    }
    CarryOver("PatchMatchStereo.geom_consistency_regularizer",
              "Hpm.geom_weight");
    CarryOver("PatchMatchStereo.geom_consistency_max_cost",
              "Hpm.geom_max_error");
    for (const Quality& quality : Qualities()) {
      if (quality.name != options.hpm.quality ||
          options.hpm.method != HpmOptions().method) {
        continue;  // the paper's methods have the paper's effort
      }
      for (const auto& [name, value] : quality.settings) {
        if (given_.count(name)) continue;
        ParseValue(value, FindOption(name)->member(&result_->options));
      }
    }
    NoteWhatHasNoEffect();
  }

  void Problem(const std::string& line) { result_->problems.push_back(line); }

 private:
  void TakeValue(const std::string& name, const std::string& text) {
    const OptionSpec* option = FindOption(name);
    if (!given_.emplace(name, text).second) {
      Problem(fmt::format("--{} is given twice; allowed: once", name));
      return;
    }
    if (text.size() > kMaxValueLength) {
      Problem(fmt::format("--{} '{}' is too long; allowed: {} characters",
                          name,
                          Shortened(text),
                          kMaxValueLength));
      return;
    }
    // Parsed into a copy: a refused value must not take part in the rules of
    // Finish().
    ToolOptions trial = result_->options;
    const OptionMember member = option->member(&trial);
    if (ParseValue(text, member) && option->allowed.contains(member)) {
      result_->options = trial;
      return;
    }
    Problem(fmt::format("--{} '{}' is not allowed; allowed: {}",
                        name,
                        Shortened(text),
                        AllowedText(*option)));
  }

  void CarryOver(const std::string& colmap_name, const std::string& hpm_name) {
    const auto value = given_.find(colmap_name);
    if (value == given_.end() || given_.count(hpm_name)) return;
    ParseValue(value->second, FindOption(hpm_name)->member(&result_->options));
  }

  void NoteWhatHasNoEffect() {
    for (const OptionSpec& option : OptionTable()) {
      if (option.no_effect.empty() || !given_.count(option.name)) continue;
      // As text, since COLMAP's 0.2f is not the 0.2 that a user types.
      if (FormatValue(option.member(&result_->options)) == DefaultText(option))
        continue;
      result_->notes.push_back(fmt::format(
          "--{} has no effect here: {}", option.name, option.no_effect));
    }
  }

  ParsedOptions* result_;
  std::map<std::string, std::string> given_;
};

// COLMAP's rule: the file takes the place of the command line.
ParsedOptions ParseProjectFile(const std::string& path) {
  ParsedOptions result;
  Interpreter interpreter(&result);
  try {
    std::istringstream file(ReadWholeFile(path, kMaxProjectFileBytes));
    interpreter.Take(
        po::parse_config_file(file, Describe(), /*allow_unregistered=*/true),
        path + ": ");
    interpreter.Finish();
  } catch (const Error& error) {
    interpreter.Problem(fmt::format("{}; check --project_path", error.what()));
  } catch (const po::error& error) {
    interpreter.Problem(fmt::format("{}: {}", path, Shortened(error.what())));
  }
  return result;
}

}  // namespace

ParsedOptions ParseOptions(const std::vector<std::string>& arguments) {
  ParsedOptions result;
  Interpreter interpreter(&result);
  try {
    po::options_description description = Describe();
    description.add_options()("help,h", "");
    const po::parsed_options parsed = po::command_line_parser(arguments)
                                          .options(description)
                                          .allow_unregistered()
                                          .run();
    po::parsed_options values(parsed.description);
    for (const po::option& option : parsed.options) {
      if (option.string_key == "help") {
        result.help = true;
        return result;
      }
      values.options.push_back(option);
    }
    interpreter.Take(values, "");
    const std::string& project_path = result.options.project_path;
    if (!project_path.empty() && result.problems.empty()) {
      ParsedOptions from_file = ParseProjectFile(project_path);
      if (values.options.size() > 1) {
        from_file.notes.push_back(
            fmt::format("only the options in {} count; the rest of the command "
                        "line is ignored",
                        project_path));
      }
      return from_file;
    }
    interpreter.Finish();
  } catch (const po::error& error) {
    interpreter.Problem(Shortened(error.what()));
  }
  return result;
}

}  // namespace hpm
