// Values of options as text: typed parsing and printing, and the set of allowed
// values. Everything here ignores the global locale.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace hpm {

// Points at the member that holds the value; the alternative is the option's
// type.
using OptionMember =
    std::variant<bool*, int*, double*, std::string*, std::filesystem::path*>;

// "bool", "int", "float", "string", "path".
std::string TypeName(const OptionMember& member);

// COLMAP's spellings: booleans are 0/1, true/false, yes/no, on/off in any case;
// int refuses "3.5"; float takes "1e-2" and refuses NaN and what is infinite as
// a C++ float. False if `text` is not of the type, and then the member is
// untouched.
bool ParseValue(std::string_view text, const OptionMember& member);

// As ParseValue reads it; floats with at most 6 significant digits.
std::string FormatValue(const OptionMember& member);

// A set of values: `text` names it for people, `contains` decides.
struct Allowed {
  std::string text;
  std::function<bool(const OptionMember&)> contains;
  std::vector<std::string> choices;  // when they can be listed
};

Allowed Anything();
Allowed AtLeast(double low);
Allowed Above(double low);
Allowed Between(double low, double high);       // both ends included
Allowed BetweenBelow(double low, double high);  // without `high`
Allowed OneOf(std::vector<std::string> choices);
Allowed OneOfAnyCase(std::vector<std::string> choices);
// COLMAP's gpu_index: comma-separated integers >= -1.
Allowed IndexList();
// Any single value; `text` states a rule between several options, checked
// elsewhere.
Allowed CheckedTogether(std::string text);

}  // namespace hpm
