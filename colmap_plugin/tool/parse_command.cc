#include "colmap_plugin/tool/parse_command.h"

#include "colmap_plugin/tool/text.h"

#include <set>

#include <fmt/format.h>

namespace hpm {
namespace {

struct Resolved {
  const CommandOption* own = nullptr;
  const OptionSpec* of_run = nullptr;
};

// What a name stands for: one of them whose name it is, or the only one that
// begins so.
Resolved Resolve(const Command& command, const std::string& name) {
  Resolved found;
  int num_found = 0;
  for (const CommandOption& option : command.options) {
    if (option.name == name) return {&option, nullptr};
    if (option.name.rfind(name, 0) != 0) continue;
    found = {&option, nullptr};
    ++num_found;
  }
  for (const OptionSpec& option : OptionTable()) {
    if (option.name == name) return {nullptr, &option};
    if (option.name.rfind(name, 0) != 0 || !Takes(command, option)) continue;
    found = {nullptr, &option};
    ++num_found;
  }
  return num_found == 1 ? found : Resolved();
}

}  // namespace

ParsedCommand ParseCommand(const Command& command,
                           const std::vector<std::string>& arguments) {
  ParsedCommand result;
  std::vector<std::string> problems;
  std::vector<std::string> others;  // for patch_match_stereo's parser
  std::set<std::string> given;
  for (size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument.rfind("--", 0) != 0) {
      others.push_back(argument);
      continue;
    }
    const size_t equals = argument.find('=');
    const std::string name =
        argument.substr(2, equals == std::string::npos ? equals : equals - 2);
    const Resolved resolved = Resolve(command, name);
    if (resolved.of_run != nullptr && !Takes(command, *resolved.of_run)) {
      problems.push_back(
          fmt::format("{} does not take --{}; see hpm_mvs help {}",
                      command.name,
                      resolved.of_run->name,
                      command.name));
      if (equals == std::string::npos) ++i;
      continue;
    }
    if (resolved.own == nullptr) {
      others.push_back(argument);
      continue;
    }
    const CommandOption& own = *resolved.own;
    if (!given.insert(own.name).second) {
      problems.push_back(
          fmt::format("--{} is given twice; allowed: once", own.name));
    }
    if (equals == std::string::npos && i + 1 == arguments.size()) {
      problems.push_back(fmt::format(
          "--{} has no value; allowed: {}", own.name, AllowedText(own)));
      continue;
    }
    const std::string value = equals == std::string::npos
                                  ? arguments[++i]
                                  : argument.substr(equals + 1);
    const OptionMember member = own.member(&result.own);
    if (!ParseValue(value, member) || !own.allowed.contains(member)) {
      problems.push_back(fmt::format("--{} '{}' is not allowed; allowed: {}",
                                     own.name,
                                     Shortened(value),
                                     AllowedText(own)));
    }
  }
  result.run = ParseOptions(others);
  result.run.problems.insert(
      result.run.problems.begin(), problems.begin(), problems.end());
  return result;
}

}  // namespace hpm
