// PatchMatchOptions in Python: the rows of the option table as attributes, and
// what callers may give in its place.
#pragma once

#include "colmap_plugin/options/option_table.h"

#include <map>
#include <string>
#include <vector>

#include <nanobind/nanobind.h>

namespace hpm {

// Only what was set, since some options follow others that are not given.
class PatchMatchOptions {
 public:
  // `name` as Python knows it: COLMAP's without their prefix, "Hpm.method", or
  // as on the command line. Throws Error(kUsage) for unknown names, with the
  // nearest one, and for values that are not allowed.
  void Set(const std::string& name, nanobind::handle value);
  nanobind::object Get(const std::string& name) const;

  // By name on the command line, without "--".
  const std::map<std::string, std::string>& given() const { return given_; }

 private:
  std::map<std::string, std::string> given_;
};

void BindOptions(nanobind::module_& module);

// `options`: None, PatchMatchOptions, a mapping, or an object with todict() as
// pycolmap.PatchMatchOptions, of which only what is not at its default counts;
// `more` go before them. Throws Error(kUsage).
PatchMatchOptions OptionsFrom(nanobind::handle options,
                              const nanobind::kwargs& more);

// By the rules of the command line, with these arguments before:
// "--name=value". Throws Error(kUsage). `notes` may be null.
ControllerOptions ParsedFrom(const PatchMatchOptions& options,
                             std::vector<std::string> arguments,
                             std::vector<std::string>* notes);

// Of str, bytes and path-like objects.
std::string PathText(nanobind::handle path);

}  // namespace hpm
