// Before hours of work: can the maps be written?
#pragma once

#include "colmap_plugin/workspace/problem.h"

#include <cstdint>
#include <vector>

namespace hpm {

// File sizes of one depth and one normal map of the camera, in bytes.
uint64_t DepthAndNormalMapBytes(const Camera& camera);

// Creates all folders the maps of the references of `problems` go to
// (sub-folders of image names included) and the state folder, writes a trial
// file into each, and compares num_bytes, what the run will write, with the
// free space of the disk. Writes fusion.cfg with all reference images if there
// is none; warns of one that stereo_fusion cannot use. Throws Error(kBadInput)
// for a folder that cannot be written and for an image name too long for its
// files,
// Error(kOutOfResources) with needed and free bytes for a full disk.
void PrepareOutputs(const Workspace& workspace,
                    const std::vector<StereoProblem>& problems,
                    uint64_t num_bytes,
                    const LogSink& log);

}  // namespace hpm
