// Before hours of work: can the maps be written?
#pragma once

#include "colmap_plugin/workspace/problem.h"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

namespace hpm {

// File sizes of one depth and one normal map of the camera, in bytes.
uint64_t DepthAndNormalMapBytes(const Camera& camera);

// Free space of the disk that the folder is on, or will be; nothing where the
// file system does not tell.
std::optional<uint64_t> FreeBytes(const std::filesystem::path& folder);

enum class OutputAccess {
  kTry,      // makes the folders and writes a trial file into each
  kInspect,  // changes nothing, and asks permissions
};

// Of all folders the maps of the references of `problems` go to (sub-folders of
// image names included) and the state folder; compares num_bytes, what the run
// will write, with the free space of the disk. Throws Error(kBadInput) for a
// folder that cannot be written and for an image name too long for its files,
// Error(kOutOfResources) with needed and free bytes for a full disk.
void CheckOutputs(const Workspace& workspace,
                  const std::vector<StereoProblem>& problems,
                  uint64_t num_bytes,
                  OutputAccess access);

// The same, by trying; then writes fusion.cfg with all reference images if
// there is none, and warns of one that stereo_fusion cannot use.
void PrepareOutputs(const Workspace& workspace,
                    const std::vector<StereoProblem>& problems,
                    uint64_t num_bytes,
                    const LogSink& log);

}  // namespace hpm
