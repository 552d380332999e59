#include "colmap_plugin/options/option_value.h"

#include "src/base/platform/numbers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace hpm {
namespace {

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  return lower;
}

bool Parse(std::string_view text, bool* value) {
  const std::string word = Lower(text);
  if (word == "1" || word == "true" || word == "yes" || word == "on") {
    *value = true;
  } else if (word == "0" || word == "false" || word == "no" || word == "off") {
    *value = false;
  } else {
    return false;
  }
  return true;
}

template <class Number>
bool ParseNumber(std::string_view text, Number* value) {
  // FromChars() knows no leading plus, COLMAP's parser does.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-')
    text.remove_prefix(1);
  Number number = 0;
  const char* end = text.data() + text.size();
  const auto [rest, error] = FromChars(text.data(), end, &number);
  if (error != std::errc() || rest != end ||
      !std::isfinite(static_cast<double>(number))) {
    return false;
  }
  *value = number;
  return true;
}

bool Parse(std::string_view text, int* value) {
  return ParseNumber(text, value);
}
bool Parse(std::string_view text, double* value) {
  // The library computes in float; a value beyond it would become infinite
  // there.
  double number = 0;
  if (!ParseNumber(text, &number)) return false;
  if (std::abs(number) > std::numeric_limits<float>::max()) return false;
  *value = number;
  return true;
}

// Strings and paths; a NUL would cut the name short in system calls.
template <class Text>
bool Parse(std::string_view text, Text* value) {
  if (text.find('\0') != std::string_view::npos) return false;
  *value = text;
  return true;
}

double AsNumber(const OptionMember& member) {
  if (const auto* integer = std::get_if<int*>(&member)) return **integer;
  return *std::get<double*>(member);
}

const std::string& AsString(const OptionMember& member) {
  return *std::get<std::string*>(member);
}

template <class Predicate>
Allowed Numbers(std::string text, Predicate predicate) {
  return {std::move(text),
          [predicate](const OptionMember& member) {
            return predicate(AsNumber(member));
          },
          {}};
}

}  // namespace

std::string TypeName(const OptionMember& member) {
  static const char* const kNames[] = {
      "bool", "int", "float", "string", "path"};
  return kNames[member.index()];
}

bool ParseValue(std::string_view text, const OptionMember& member) {
  return std::visit([text](auto* value) { return Parse(text, value); }, member);
}

std::string FormatValue(const OptionMember& member) {
  struct Formatter {
    std::string operator()(const bool* value) const {
      return *value ? "1" : "0";
    }
    std::string operator()(const int* value) const {
      return fmt::format("{}", *value);
    }
    std::string operator()(const double* value) const {
      return fmt::format("{:.6g}", *value);
    }
    std::string operator()(const std::string* value) const { return *value; }
    std::string operator()(const std::filesystem::path* value) const {
      return value->string();
    }
  };
  return std::visit(Formatter(), member);
}

Allowed Anything() {
  return {"", [](const OptionMember&) { return true; }, {}};
}

Allowed AtLeast(double low) {
  return Numbers(fmt::format(">= {}", low),
                 [low](double value) { return value >= low; });
}

Allowed Above(double low) {
  return Numbers(fmt::format("> {}", low),
                 [low](double value) { return value > low; });
}

Allowed Between(double low, double high) {
  return Numbers(fmt::format("{} to {}", low, high), [low, high](double value) {
    return value >= low && value <= high;
  });
}

Allowed BetweenBelow(double low, double high) {
  return Numbers(
      fmt::format(">= {} and < {}", low, high),
      [low, high](double value) { return value >= low && value < high; });
}

Allowed OneOf(std::vector<std::string> choices) {
  return {fmt::format("{}", fmt::join(choices, ", ")),
          [choices](const OptionMember& member) {
            return std::find(choices.begin(),
                             choices.end(),
                             AsString(member)) != choices.end();
          },
          choices};
}

Allowed OneOfAnyCase(std::vector<std::string> choices) {
  return {fmt::format("{} (any case)", fmt::join(choices, ", ")),
          [choices](const OptionMember& member) {
            const std::string value = Lower(AsString(member));
            return std::any_of(choices.begin(),
                               choices.end(),
                               [&value](const std::string& choice) {
                                 return Lower(choice) == value;
                               });
          },
          choices};
}

Allowed IndexList() {
  return {"comma-separated integers >= -1",
          [](const OptionMember& member) {
            std::string_view rest = AsString(member);
            while (true) {
              const size_t comma = rest.find(',');
              int index = 0;
              if (!Parse(rest.substr(0, comma), &index) || index < -1)
                return false;
              if (comma == std::string_view::npos) return true;
              rest.remove_prefix(comma + 1);
            }
          },
          {}};
}

Allowed CheckedTogether(std::string text) {
  return {std::move(text), [](const OptionMember&) { return true; }, {}};
}

}  // namespace hpm
