// What the given options amount to: "the method's own" becomes a number, and
// what has no say under the others its default. The same maps come from the
// result, and options that mean the same give the same result.
#pragma once

#include "colmap_plugin/options/options.h"

namespace hpm {

// An automatic num_levels stays: it takes the sizes of the images. Throws
// Error(kUsage) for an unknown method.
ControllerOptions EffectiveOptions(ControllerOptions options);

}  // namespace hpm
