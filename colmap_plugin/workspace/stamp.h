// How resume knows that the maps on disk were made with the present options
// from the present inputs, and are still as they were made:
// stereo/hpm_mvs/stamps/<stage>/<image name>.json, written after the maps,
// holds the fingerprint they were made with, what their files are like, and
// statistics for whoever is curious.
#pragma once

#include "colmap_plugin/formats/published_file.h"

#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

struct Stamp {
  std::string fingerprint;
  std::map<std::string, PublishedFile> files;  // "depth", "normal", "graph"
  // An object (or null); its members stand beside the others.
  nlohmann::json statistics;
};

// Throws Error(kBadInput) for an image name that is not a path inside the
// folder.
std::filesystem::path StampPath(const std::filesystem::path& state_path,
                                const std::string& image_name,
                                const std::string& stage);

// Atomic; throws as WriteFileAtomically does.
void WriteStamp(const std::filesystem::path& state_path,
                const std::string& image_name,
                const std::string& stage,
                const Stamp& stamp);

// Before maps are replaced: from then on they are finished only with a new
// stamp.
void RemoveStamp(const std::filesystem::path& state_path,
                 const std::string& image_name,
                 const std::string& stage);

// Nothing if the stamp is absent, damaged or of another version of this file:
// the maps are then made anew.
std::optional<Stamp> ReadStamp(const std::filesystem::path& state_path,
                               const std::string& image_name,
                               const std::string& stage);

}  // namespace hpm
