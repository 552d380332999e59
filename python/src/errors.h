// The exceptions of the package: one class for each exit code of the program.
#pragma once

#include "src/base/error.h"

#include <string>

#include <nanobind/nanobind.h>

namespace hpm {

// Adds the classes, and translates Error into them.
void BindErrors(nanobind::module_& module);

// Raises the class of the code, with the attribute given.
[[noreturn]] void RaiseWith(ErrorCode code,
                            const std::string& message,
                            const char* attribute,
                            const nanobind::object& value);

}  // namespace hpm
