// estimate() of arrays that python/hpm_mvs/_estimate.py has checked.
#pragma once

#include <nanobind/nanobind.h>

namespace hpm {

void BindEstimate(nanobind::module_& module);

}  // namespace hpm
