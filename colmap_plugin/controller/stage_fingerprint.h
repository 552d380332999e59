// Hashes of all that the maps of one stage depend on, beside the maps of the
// stage before: see StagePlan.
#pragma once

#include "colmap_plugin/controller/image_contents.h"
#include "colmap_plugin/options/options.h"
#include "colmap_plugin/workspace/fingerprint.h"
#include "colmap_plugin/workspace/problem.h"
#include "src/engine/schedule.h"

#include <string>

namespace hpm {

// Every member counts: the numbers of the method's row, and those of a pass.
void AddToFingerprint(const MethodParams& params, Fingerprint* hash);
void AddToFingerprint(const Pass& pass, Fingerprint* hash);

// What is the same for all problems: the options that concern the stage, and
// its passes. is_final: its maps are the result of the run.
std::string FingerprintOfStage(const std::string& name,
                               const StageSpec& stage,
                               bool is_final,
                               const ControllerOptions& options);

// That, and what the problem brings: images, cameras, depth ranges.
std::string OwnFingerprint(const Workspace& workspace,
                           const ImageContents& contents,
                           const StereoProblem& problem,
                           bool is_final,
                           const std::string& fingerprint_of_stage);

}  // namespace hpm
