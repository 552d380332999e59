// How resume knows that the maps on disk were made with the present options
// from the present inputs, and are still as they were made:
// stereo/hpm_mvs/stamps/<stage>/<image name>.json, written after the maps,
// holds the fingerprint they were made with, what their files are like, and
// statistics for whoever is curious. A power cut may take a stamp, and then its
// maps are made again.
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
  std::map<std::string, PublishedFile>
      files;  // "depth", "normal", "graph", "confidence"
  // An object (or null); its members stand beside the others.
  nlohmann::json statistics = nullptr;
  // Of maps that were not synced to the disk: UnsyncedSince() of
  // file_system.h. On any other kernel, or where it is empty, length and time
  // do not tell whether the bytes are there.
  std::optional<std::string> unsynced_since;
};

// Throws Error(kBadInput) for an image name that is not a path inside the
// folder.
std::filesystem::path StampPath(const std::filesystem::path& state_path,
                                const std::string& image_name,
                                const std::string& stage);

// Atomic; throws as WriteFileAtomically does. Not synced: the maps are, before.
void WriteStamp(const std::filesystem::path& state_path,
                const std::string& image_name,
                const std::string& stage,
                const Stamp& stamp);

// After it a power cut takes no stamp of the stage any more. Errors are none:
// what is lost is made again.
void SyncStamps(const std::filesystem::path& state_path,
                const std::string& stage);

// Before maps are replaced: from then on they are finished only with a new
// stamp.
void RemoveStamp(const std::filesystem::path& state_path,
                 const std::string& image_name,
                 const std::string& stage);

// Nothing if the stamp is absent, unreadable, damaged or of another version of
// this file: the maps are then made anew.
std::optional<Stamp> ReadStamp(const std::filesystem::path& state_path,
                               const std::string& image_name,
                               const std::string& stage);
// The same of the file at `path`, but throws UnreadableFile.
std::optional<Stamp> ReadStampFile(const std::filesystem::path& path);

}  // namespace hpm
