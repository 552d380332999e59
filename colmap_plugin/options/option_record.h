// The options of a run as its record holds them.
#pragma once

#include "colmap_plugin/options/options.h"

#include <nlohmann/json.hpp>

namespace hpm {

// By name, as they took effect (EffectiveOptions); without those that have no
// effect.
nlohmann::json OptionRecord(const ControllerOptions& options);

}  // namespace hpm
