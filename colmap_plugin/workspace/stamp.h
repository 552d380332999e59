// How resume knows that the maps on disk were made with the present options:
// stereo/hpm_mvs/stamps/<stage>/<image name>.json, written after the maps,
// holds the fingerprint they were made with, beside statistics for whoever is
// curious.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

// Throws Error(kBadInput) for an image name that is not a path inside the
// folder.
std::filesystem::path StampPath(const std::filesystem::path& state_path,
                                const std::string& image_name,
                                const std::string& stage);

// `statistics` is an object (or null); its members stand beside "fingerprint".
// Atomic; throws as WriteFileAtomically does.
void WriteStamp(const std::filesystem::path& state_path,
                const std::string& image_name,
                const std::string& stage,
                const std::string& fingerprint,
                const nlohmann::json& statistics);

// Before maps are replaced: from then on they are finished only with a new
// stamp.
void RemoveStamp(const std::filesystem::path& state_path,
                 const std::string& image_name,
                 const std::string& stage);

// Nothing if the stamp is absent or damaged: the maps are then made anew.
std::optional<std::string> ReadStampFingerprint(
    const std::filesystem::path& state_path,
    const std::string& image_name,
    const std::string& stage);

}  // namespace hpm
