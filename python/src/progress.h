// Progress events, and Python callables that take them.
#pragma once

#include "colmap_plugin/controller/controller.h"
#include "python/src/background_run.h"

#include <nanobind/nanobind.h>

namespace hpm {

void BindProgress(nanobind::module_& module);

// Throws Error(kUsage) if it is neither None nor callable.
void CheckCallback(nanobind::handle callback);

// What calls it in the calling thread of the run; None: nothing. Needs no GIL.
ProgressSink ProgressTo(nanobind::handle callback, const Post& post);

}  // namespace hpm
