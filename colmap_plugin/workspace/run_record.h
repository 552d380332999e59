// stereo/hpm_mvs/run.json: what the last run did, for people and scripts; runs
// on shards have records of their own.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

namespace hpm {

// name: of the file. Atomic. Throws as WriteFileAtomically does.
void WriteRunRecord(const std::filesystem::path& state_path,
                    const std::string& name,
                    const nlohmann::json& record);

}  // namespace hpm
