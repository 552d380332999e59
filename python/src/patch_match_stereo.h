// patch_match_stereo() and what it returns.
#pragma once

#include <nanobind/nanobind.h>

namespace hpm {

void BindPatchMatchStereo(nanobind::module_& module);

}  // namespace hpm
