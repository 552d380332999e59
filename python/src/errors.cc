#include "python/src/errors.h"

#include "colmap_plugin/controller/run_share.h"
#include "colmap_plugin/tool/name_options.h"

#include <exception>
#include <map>

#include <nanobind/stl/string.h>

namespace nb = nanobind;

namespace hpm {
namespace {

struct ErrorClass {
  ErrorCode code;
  const char* name;
  const char* doc;
  PyObject* other_base;  // null: none
};

// They live as long as the process.
std::map<ErrorCode, PyObject*>& Classes() {
  static std::map<ErrorCode, PyObject*> classes;
  return classes;
}

PyObject* NewClass(nb::module_& module,
                   const char* name,
                   const char* doc,
                   const nb::object& bases) {
  const std::string full_name =
      nb::cast<std::string>(module.attr("__name__")) + "." + name;
  PyObject* made =
      PyErr_NewExceptionWithDoc(full_name.c_str(), doc, bases.ptr(), nullptr);
  if (made == nullptr) throw nb::python_error();
  module.attr(name) = nb::handle(made);
  return made;
}

// What nanobind's own translator would make of it is not ours.
void Translate(const std::exception_ptr& thrown, void*) {
  try {
    std::rethrow_exception(thrown);
  } catch (const Error& error) {
    PyErr_SetString(Classes().at(error.code()),
                    NameOptions(error.what()).c_str());
  }
}

}  // namespace

void BindErrors(nb::module_& module) {
  const ErrorClass table[] = {
      {ErrorCode::kFailure, "Failure", "Anything unforeseen.", nullptr},
      {ErrorCode::kUsage,
       "UsageError",
       "An option or argument that is not allowed.",
       PyExc_ValueError},
      {ErrorCode::kBadInput,
       "InputError",
       "A file of the workspace is missing, damaged or contradictory.",
       nullptr},
      {ErrorCode::kPartial,
       "PartialError",
       "Some images failed; the maps of the others are valid. The attribute\n"
       "summary is the RunSummary, summary.failed has their names.",
       nullptr},
      {ErrorCode::kOutOfResources,
       "ResourcesError",
       "Out of memory or disk.",
       nullptr},
      {ErrorCode::kDevice,
       "DeviceError",
       "The device asked for cannot be used.",
       nullptr},
      {ErrorCode::kLocked,
       "LockedError",
       "Another run works on this workspace.",
       nullptr},
      {kNotReady,
       "NotReadyError",
       "With Hpm.shard or Hpm.stage: maps of other shards or stages are not "
       "there yet.",
       nullptr},
      {ErrorCode::kInterrupted,
       "InterruptedRunError",
       "The run was stopped, and not by this process: Ctrl-C raises\n"
       "KeyboardInterrupt.",
       nullptr},
  };
  const nb::object runtime_error = nb::borrow(PyExc_RuntimeError);
  PyObject* base = NewClass(module,
                            "Error",
                            "What a run can end with. exit_code is that of the "
                            "program hpm_mvs.",
                            runtime_error);
  nb::handle(base).attr("exit_code") = static_cast<int>(ErrorCode::kFailure);
  for (const ErrorClass& row : table) {
    nb::object bases = nb::make_tuple(nb::handle(base));
    if (row.other_base != nullptr)
      bases = nb::make_tuple(nb::handle(base), nb::handle(row.other_base));
    PyObject* made = NewClass(module, row.name, row.doc, bases);
    nb::handle(made).attr("exit_code") = static_cast<int>(row.code);
    Classes()[row.code] = made;
  }
  nb::register_exception_translator(Translate);
}

void RaiseWith(ErrorCode code,
               const std::string& message,
               const char* attribute,
               const nb::object& value) {
  const nb::handle its_class(Classes().at(code));
  const nb::object error = its_class(message.c_str());
  error.attr(attribute) = value;
  PyErr_SetObject(its_class.ptr(), error.ptr());
  throw nb::python_error();
}

}  // namespace hpm
