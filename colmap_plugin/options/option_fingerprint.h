// The options' part of the fingerprint of a stage's maps: the values of all
// options that concern it (Concerns in option_table.h).
#pragma once

#include "colmap_plugin/options/options.h"
#include "colmap_plugin/workspace/fingerprint.h"
#include "src/engine/schedule.h"

namespace hpm {

// Of the options as they take effect (EffectiveOptions). is_final: the maps of
// the stage are the result of the run.
void AddOptions(const ControllerOptions& options,
                const StageSpec& stage,
                bool is_final,
                Fingerprint* hash);

}  // namespace hpm
