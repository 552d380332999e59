// What differs between COLMAP's versions for the code of this module, and
// nothing else of it. Compiled inside COLMAP, from C++14 (3.8 to 3.10) on; a
// version is known by the headers it has.
#pragma once

#if __has_include("colmap/mvs/patch_match.h")  // 3.9 and later
#include "colmap/math/random.h"
#include "colmap/mvs/patch_match.h"
#include "colmap/util/logging.h"
#else
#include "mvs/patch_match.h"
#include "util/logging.h"
#include "util/random.h"
#endif

#if __has_include("colmap/util/base_controller.h")  // 3.10 and later
#include "colmap/util/base_controller.h"
#define HPM_COLMAP_HAS_BASE_CONTROLLER
#elif __has_include("colmap/util/threading.h")
#include "colmap/util/threading.h"
#else
#include "util/threading.h"
#endif

#include <string>

#if __has_include("colmap/mvs/patch_match_options.h")  // 3.12 and later
#include <filesystem>
#endif

// COLMAP's own stereo is there to choose from.
#if defined(CUDA_ENABLED) || defined(COLMAP_CUDA_ENABLED) || \
    defined(COLMAP_HIP_ENABLED)
#define HPM_COLMAP_HAS_OWN_STEREO
#endif

namespace hpm {
namespace in_colmap {

#ifdef HPM_COLMAP_HAS_BASE_CONTROLLER
using ControllerBase = colmap::BaseController;
#else
using ControllerBase = colmap::Thread;
#endif

// COLMAP hands over strings up to 3.13, of which a path is made silently.
#if __has_include("colmap/mvs/patch_match_options.h")
using Path = std::filesystem::path;
#else
using Path = std::string;
#endif

}  // namespace in_colmap
}  // namespace hpm
