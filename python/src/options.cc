#include "python/src/options.h"

#include "colmap_plugin/tool/parse_options.h"
#include "colmap_plugin/tool/text.h"
#include "src/base/error.h"

#include <algorithm>
#include <filesystem>
#include <variant>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace nb = nanobind;

namespace hpm {
namespace {

const std::string kColmapPrefix = "PatchMatchStereo.";
const std::string kOurPrefix = "Hpm.";

bool StartsWith(const std::string& text, const std::string& prefix) {
  return text.compare(0, prefix.size(), prefix) == 0;
}

// Not what a function has as arguments of their own, and not what is about the
// program's command line and output.
bool IsOption(const OptionSpec& row) {
  static const std::vector<std::string> others = {"workspace_path",
                                                  "workspace_format",
                                                  "pmvs_option_name",
                                                  "config_path",
                                                  "project_path",
                                                  "Hpm.log_format"};
  return std::find(others.begin(), others.end(), row.name) == others.end() &&
         !StartsWith(row.name, "log_");
}

// The shortest name that Set() takes.
std::string PythonName(const OptionSpec& row) {
  return StartsWith(row.name, kColmapPrefix)
             ? row.name.substr(kColmapPrefix.size())
             : row.name;
}

std::vector<std::string> PythonNames() {
  std::vector<std::string> names;
  for (const OptionSpec& row : OptionTable()) {
    if (IsOption(row)) names.push_back(PythonName(row));
  }
  return names;
}

const OptionSpec* Find(const std::string& name) {
  for (const std::string& prefix : {std::string(), kColmapPrefix}) {
    const OptionSpec* row = FindOption(prefix + name);
    if (row != nullptr && IsOption(*row)) return row;
  }
  return nullptr;
}

// The name that looks most like it: of an option without its group first, since
// that is what people leave out.
std::string NearestName(const std::string& name) {
  if (Find(kOurPrefix + name) != nullptr) return kOurPrefix + name;
  const nb::object close = nb::module_::import_("difflib").attr(
      "get_close_matches")(name, PythonNames(), 1, 0.0);
  return nb::cast<std::string>(close[0]);
}

const OptionSpec& Row(const std::string& name) {
  const OptionSpec* row = Find(name);
  if (row == nullptr) {
    throw Error(ErrorCode::kUsage,
                fmt::format("unknown option '{}'; did you mean '{}'?",
                            Shortened(name),
                            NearestName(name)));
  }
  return *row;
}

std::string ValueText(nb::handle value) {
  const bool is_path =
      PyBytes_Check(value.ptr()) || nb::hasattr(value, "__fspath__");
  return is_path ? PathText(value) : nb::cast<std::string>(nb::str(value));
}

struct ToPython {
  template <class T>
  nb::object operator()(const T* value) const {
    return nb::cast(*value);
  }
  // As text: an empty path would become ".".
  nb::object operator()(const std::filesystem::path* path) const {
    return nb::steal(PyUnicode_DecodeFSDefault(path->string().c_str()));
  }
};

nb::object ValueOf(const OptionSpec& row, ToolOptions* options) {
  return std::visit(ToPython(), row.member(options));
}

// Of the type hints.
const char* PythonType(const OptionSpec& row, bool is_argument) {
  ToolOptions options;
  const std::string type = TypeName(row.member(&options));
  if (type == "string") return "str";
  if (type == "path") return is_argument ? "str | os.PathLike[str]" : "str";
  return type == "bool" ? "bool" : type == "int" ? "int" : "float";
}

// PatchMatchOptions.hpm, for the options of another group.
struct HpmGroup {
  PatchMatchOptions* options;
};

PatchMatchOptions& Of(PatchMatchOptions& options) { return options; }
PatchMatchOptions& Of(const HpmGroup& group) { return *group.options; }

// An attribute for each option whose name has the prefix and no other dot.
template <class Class>
void AddAttributes(const std::string& prefix, nb::class_<Class>* bound) {
  for (const OptionSpec& row : OptionTable()) {
    const std::string option = PythonName(row);
    if (!IsOption(row) || !StartsWith(option, prefix)) continue;
    const std::string name = option.substr(prefix.size());
    if (name.find('.') != std::string::npos) continue;
    const std::string get =
        fmt::format("def {}(self, /) -> {}", name, PythonType(row, false));
    const std::string set = fmt::format(
        "def {}(self, value: {}, /) -> None", name, PythonType(row, true));
    const std::string help =
        fmt::format("{}. Allowed: {}", row.help, AllowedText(row));
    const OptionSpec* of = &row;
    bound->def_prop_rw(
        name.c_str(),
        [of](Class& self) { return Of(self).Get(of->name); },
        [of](Class& self, nb::handle value) { Of(self).Set(of->name, value); },
        nb::for_getter(nb::sig(get.c_str())),
        nb::for_setter(nb::sig(set.c_str())),
        help.c_str());
  }
}

// Values that are the same as text are the same: COLMAP's 0.2f is not our 0.2.
bool IsDefault(const OptionSpec& row, nb::handle value) {
  ToolOptions options;
  const OptionMember member = row.member(&options);
  return ParseValue(ValueText(value), member) &&
         FormatValue(member) == DefaultText(row);
}

// As pycolmap's: an option that is not ours matters only if somebody set it.
void TakeForeign(nb::handle foreign, PatchMatchOptions* options) {
  const nb::dict values = nb::cast<nb::dict>(foreign.attr("todict")());
  nb::dict defaults;
  try {
    defaults = nb::cast<nb::dict>(foreign.type()().attr("todict")());
  } catch (const nb::python_error&) {
    // It cannot be made without arguments; then all of it counts as set.
  }
  for (const auto& [key, value] : values) {
    const std::string name = nb::cast<std::string>(nb::str(key));
    const OptionSpec* row = Find(name);
    if (row == nullptr) {
      const bool is_set =
          !defaults.contains(key) || !defaults[key].equal(value);
      if (!is_set) continue;
    } else if (IsDefault(*row, value)) {
      continue;
    }
    options->Set(name, value);
  }
}

// Only what was set, so that options made of it are the same.
nb::dict Values(const PatchMatchOptions& options) {
  nb::dict values;
  for (const auto& [name, text] : options.given())
    values[PythonName(Row(name)).c_str()] = options.Get(name);
  return values;
}

std::string Repr(const PatchMatchOptions& options) {
  const nb::dict values = Values(options);
  return fmt::format("PatchMatchOptions({})",
                     values.size() == 0
                         ? std::string()
                         : nb::cast<std::string>(nb::repr(values)));
}

}  // namespace

std::string PathText(nb::handle path) {
  PyObject* encoded = nullptr;
  if (!PyUnicode_FSConverter(path.ptr(), &encoded)) throw nb::python_error();
  const nb::object bytes = nb::steal(encoded);
  return {PyBytes_AsString(encoded),
          static_cast<size_t>(PyBytes_Size(encoded))};
}

void PatchMatchOptions::Set(const std::string& name, nb::handle value) {
  const OptionSpec& row = Row(name);
  const std::string text = ValueText(value);
  ToolOptions options;
  const OptionMember member = row.member(&options);
  if (!ParseValue(text, member) || !row.allowed.contains(member)) {
    throw Error(ErrorCode::kUsage,
                fmt::format("{} '{}' is not allowed; allowed: {}",
                            PythonName(row),
                            Shortened(text),
                            AllowedText(row)));
  }
  given_[row.name] = text;
}

nb::object PatchMatchOptions::Get(const std::string& name) const {
  const OptionSpec& row = Row(name);
  ToolOptions options;
  const auto given = given_.find(row.name);
  if (given != given_.end()) ParseValue(given->second, row.member(&options));
  return ValueOf(row, &options);
}

void BindOptions(nb::module_& module) {
  nb::class_<HpmGroup> hpm(
      module, "HpmOptions", "The options that COLMAP does not have.");
  AddAttributes(kOurPrefix, &hpm);

  nb::class_<PatchMatchOptions> options(
      module,
      "PatchMatchOptions",
      "Options by COLMAP's names, as pycolmap.PatchMatchOptions; those that "
      "COLMAP does not\nhave are in hpm. docs/options.md has all of them.");
  AddAttributes("", &options);
  options
      .def(
          "__init__",
          [](PatchMatchOptions* self,
             nb::handle values,
             const nb::kwargs& more) {
            new (self) PatchMatchOptions(OptionsFrom(values, more));
          },
          nb::arg("values").none() = nb::none(),
          nb::arg("options"),
          "values: a mapping of names to values (\"Hpm.method\" for those of "
          "hpm), or options\nof pycolmap; options: the same as keywords.")
      .def_prop_ro(
          "hpm",
          [](PatchMatchOptions& self) { return HpmGroup{&self}; },
          nb::keep_alive<0, 1>(),
          "The options that COLMAP does not have")
      .def("__getitem__", &PatchMatchOptions::Get, nb::arg("name"))
      .def("__setitem__",
           &PatchMatchOptions::Set,
           nb::arg("name"),
           nb::arg("value"))
      .def("todict", Values, "What was set, by name.")
      .def("__repr__", Repr);
}

PatchMatchOptions OptionsFrom(nb::handle options, const nb::kwargs& more) {
  PatchMatchOptions result;
  if (nb::isinstance<PatchMatchOptions>(options)) {
    result = nb::cast<PatchMatchOptions>(options);
  } else if (nb::hasattr(options, "keys")) {
    for (const nb::handle name : options.attr("keys")())
      result.Set(nb::cast<std::string>(nb::str(name)), options[name]);
  } else if (nb::hasattr(options, "todict")) {
    TakeForeign(options, &result);
  } else if (!options.is_none()) {
    throw Error(
        ErrorCode::kUsage,
        fmt::format("options: {} is none; give PatchMatchOptions, those "
                    "of pycolmap, or a dict",
                    Shortened(nb::cast<std::string>(nb::repr(options)))));
  }
  for (const auto& [name, value] : more)
    result.Set(nb::cast<std::string>(name), value);
  return result;
}

ControllerOptions ParsedFrom(const PatchMatchOptions& options,
                             std::vector<std::string> arguments,
                             std::vector<std::string>* notes) {
  for (const auto& [name, text] : options.given()) {
    // Nothing can be given as nothing only where that is the default.
    if (!text.empty()) arguments.push_back("--" + name + "=" + text);
  }
  const ParsedOptions parsed = ParseOptions(arguments);
  if (!parsed.problems.empty()) {
    throw Error(ErrorCode::kUsage,
                fmt::format("{}", fmt::join(parsed.problems, "\n")));
  }
  if (notes != nullptr) *notes = parsed.notes;
  return parsed.options.controller;
}

}  // namespace hpm
